// SPDX-License-Identifier: GPL-3.0-or-later
#include "thesis/scattered.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/parallel.h"
#include "thesis/kd_tree.h"
#include "thesis/moments.h"

namespace leaflight {
namespace {

constexpr int widest_shepard_of_all = 8;
constexpr int widest_other = 32;
constexpr std::size_t nearest_samples = 64;
constexpr std::size_t texels_per_piece = 256;

template <int D>
class Interpolator {
 public:
  Interpolator(const TexelLattice<D>& lattice, const std::vector<Vec<D>>& positions,
               const std::vector<Rgb>& values, const ScatteredSettings& settings,
               Progress& progress)
      : lattice_(lattice),
        positions_(positions),
        values_(values),
        settings_(settings),
        progress_(progress) {
    texels_.value.assign(lattice.active.size(), Rgb(0));
    texels_.error.assign(lattice.active.size(), 0);
    texels_.count.assign(lattice.active.size(), 0);
  }

  ScatteredTexels run() {
    if (settings_.filter == ScatteredFilter::shepard && settings_.radius > widest_shepard_of_all) {
      gather_nearest();
    } else {
      gather_bins();
    }
    fill_gaps();
    return std::move(texels_);
  }

 private:
  // Returns the position in texels.
  Vec<D> position_of(std::uint32_t sample) const {
    return positions_[sample] / lattice_.voxels_per_texel;
  }

  double weight(double distance2) const {
    switch (settings_.filter) {
      case ScatteredFilter::shepard: {
        // A sample on the texel outweighs all others, but its weight stays finite.
        const double d2 = std::max(distance2, 1e-16);
        return 1 / (d2 * d2 * std::sqrt(d2));
      }
      case ScatteredFilter::tent:
        return std::max(0.0, 1 - std::sqrt(distance2) / (settings_.radius + 0.5));
      case ScatteredFilter::box:
        break;
    }
    return 1;
  }

  void add(const Vec<D>& texel, std::uint32_t sample, Moments& samples) const {
    const double w = weight((position_of(sample) - texel).length2());
    if (w > 0) samples.add(values_[sample], w);
  }

  void store(const Moments& samples, std::size_t slot) {
    const Average average = samples.average();
    texels_.value[slot] = average.mean;
    texels_.count[slot] = samples.count();
    texels_.error[slot] = std::sqrt(average.variance);
  }

  // Visits the samples of each nearest texel within the radius, in their order.
  void gather_bins() {
    std::vector<std::uint32_t> texel_of(positions_.size());
    std::vector<std::uint32_t> first(lattice_.texels() + 1, 0);
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      const auto sample = static_cast<std::uint32_t>(i);
      texel_of[i] =
          static_cast<std::uint32_t>(lattice_.linear(lattice_.nearest_texel(position_of(sample))));
      ++first[texel_of[i] + 1];
    }
    for (std::size_t t = 1; t < first.size(); ++t) first[t] += first[t - 1];
    std::vector<std::uint32_t> samples(positions_.size()), next(first.begin(), first.end() - 1);
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      samples[next[texel_of[i]]++] = static_cast<std::uint32_t>(i);
    }
    for_each_slot([&](std::size_t slot) {
      const Index<D> texel = lattice_.texel(lattice_.active[slot]);
      // Process rows along axis 0, which are adjacent in memory.
      Index<D> low, high;
      for (int a = 0; a < D; ++a) {
        low[a] = std::max(0, texel[a] - settings_.radius);
        high[a] = std::min(lattice_.resolution[a], texel[a] + settings_.radius + 1);
      }
      const std::size_t row = high[0] - low[0];
      high[0] = low[0] + 1;
      Moments moments;
      for_each_index<D>(low, high, [&](const Index<D>& begin) {
        const std::size_t bin = lattice_.linear(begin);
        for (std::uint32_t s = first[bin]; s < first[bin + row]; ++s) {
          add(to_vector<D>(texel), samples[s], moments);
        }
      });
      store(moments, slot);
    });
  }

  void gather_nearest() {
    std::vector<typename KdTree<D>::Point> points(positions_.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec<D> p = position_of(static_cast<std::uint32_t>(i));
      for (int a = 0; a < D; ++a) points[i][a] = static_cast<float>(p[a]);
    }
    const KdTree<D> tree(std::move(points));
    // The search reaches the corner of the filter's cube of texels.
    const double limit2 = D * std::pow(settings_.radius + 0.5, 2);
    for_each_slot([&](std::size_t slot) {
      const Index<D> texel = lattice_.texel(lattice_.active[slot]);
      std::vector<Neighbor> found;
      tree.nearest(query(texel), nearest_samples, limit2, found);
      std::sort(found.begin(), found.end(),
                [](const Neighbor& a, const Neighbor& b) { return a.number < b.number; });
      Moments moments;
      for (const Neighbor& n : found) {
        const Index<D> at = lattice_.nearest_texel(position_of(n.number));
        bool reaches = true;
        for (int a = 0; a < D; ++a) {
          reaches = reaches && std::abs(at[a] - texel[a]) <= settings_.radius;
        }
        if (reaches) add(to_vector<D>(texel), n.number, moments);
      }
      store(moments, slot);
    });
  }

  void fill_gaps() {
    std::vector<std::size_t> gaps, filled;
    for (std::size_t slot = 0; slot < texels_.count.size(); ++slot) {
      (texels_.count[slot] == 0 ? gaps : filled).push_back(slot);
    }
    if (gaps.empty()) return;
    if (filled.empty()) {
      throw Error(
          "No sample reaches any texel; take more samples, or give the filter a larger radius.");
    }
    std::vector<typename KdTree<D>::Point> points(filled.size());
    for (std::size_t i = 0; i < filled.size(); ++i) {
      const Index<D> texel = lattice_.texel(lattice_.active[filled[i]]);
      for (int a = 0; a < D; ++a) points[i][a] = static_cast<float>(texel[a]);
    }
    const KdTree<D> tree(std::move(points));
    parallel_range(
        gaps.size(), texels_per_piece, 0, progress_, [&](std::size_t begin, std::size_t end) {
          std::vector<Neighbor> found;
          for (std::size_t g = begin; g < end; ++g) {
            const auto q = query(lattice_.texel(lattice_.active[gaps[g]]));
            tree.nearest(q, 1, std::numeric_limits<double>::infinity(), found);
            // Squared distances of texels are integers.
            const double nearest2 = found[0].distance2;
            tree.nearest(q, filled.size(), nearest2 + 0.5, found);
            std::sort(found.begin(), found.end(),
                      [](const Neighbor& a, const Neighbor& b) { return a.number < b.number; });
            Imath::V3d sum(0);
            double error = 0;
            for (const Neighbor& n : found) {
              sum += Imath::V3d(texels_.value[filled[n.number]]);
              error += texels_.error[filled[n.number]];
            }
            const auto count = static_cast<double>(found.size());
            texels_.value[gaps[g]] = Rgb(sum / count);
            texels_.error[gaps[g]] = static_cast<float>(error / count);
          }
        });
  }

  static typename KdTree<D>::Query query(const Index<D>& texel) {
    typename KdTree<D>::Query q;
    for (int a = 0; a < D; ++a) q[a] = texel[a];
    return q;
  }

  template <class Body>
  void for_each_slot(Body body) {
    parallel_range(texels_.value.size(), texels_per_piece, 0, progress_,
                   [&](std::size_t begin, std::size_t end) {
                     for (std::size_t slot = begin; slot < end; ++slot) body(slot);
                   });
  }

  const TexelLattice<D>& lattice_;
  const std::vector<Vec<D>>& positions_;
  const std::vector<Rgb>& values_;
  const ScatteredSettings& settings_;
  Progress& progress_;
  ScatteredTexels texels_;
};

}  // namespace

ScatteredFilter scattered_filter_from(const std::string& name) {
  if (name == "shepard") return ScatteredFilter::shepard;
  if (name == "tent") return ScatteredFilter::tent;
  if (name == "box") return ScatteredFilter::box;
  throw Error("There is no filter named '" + name + "'; choose shepard, tent or box.");
}

template <int D>
ScatteredTexels interpolate_scattered(const TexelLattice<D>& lattice,
                                      const std::vector<Vec<D>>& positions,
                                      const std::vector<Rgb>& values,
                                      const ScatteredSettings& settings, Progress& progress) {
  if (positions.empty() || positions.size() > std::numeric_limits<std::uint32_t>::max()) {
    throw Error("There are " + std::to_string(positions.size()) +
                " samples to interpolate; take between 1 and 4294967295.");
  }
  if (positions.size() != values.size()) {
    throw Error("There are " + std::to_string(positions.size()) + " sample positions but " +
                std::to_string(values.size()) + " values; give one of each per sample.");
  }
  const bool shepard = settings.filter == ScatteredFilter::shepard;
  const int widest = shepard ? 65535 : widest_other;
  if (settings.radius < 0 || settings.radius > widest) {
    throw Error("The filter's radius is " + std::to_string(settings.radius) +
                " texels; choose between 0 and " + std::to_string(widest) +
                (shepard ? "." : ", or Shepard's filter."));
  }
  return Interpolator<D>(lattice, positions, values, settings, progress).run();
}

template ScatteredTexels interpolate_scattered<2>(const TexelLattice<2>&,
                                                  const std::vector<Vec<2>>&,
                                                  const std::vector<Rgb>&, const ScatteredSettings&,
                                                  Progress&);
template ScatteredTexels interpolate_scattered<3>(const TexelLattice<3>&,
                                                  const std::vector<Vec<3>>&,
                                                  const std::vector<Rgb>&, const ScatteredSettings&,
                                                  Progress&);

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/measured_error.h"

#include <cmath>
#include <limits>

namespace leaflight {
namespace {

constexpr int points_a_volume = 2048;
constexpr std::size_t points_a_part = 512;

// Returns the paths of an estimate. Small errors need more paths, or noise hides them.
int paths_to_measure(double error) {
  const double percents = 1.5 / error;
  return static_cast<int>(std::clamp(16 * percents * percents, 16.0, 32.0));
}

// Computes the probability of each point. One half is proportional to area. The other half gives
// equal shares to all parts of the isovalue range that have their own estimate.
template <int D>
std::vector<double> chances(const std::vector<AreaPoint<D>>& points, const IsovalueErrors& parts) {
  std::array<double, IsovalueErrors::parts> areas{};
  double all = 0;
  for (const AreaPoint<D>& point : points) {
    areas[parts.part_of(point.c)] += point.area;
    all += point.area;
  }
  const auto is_large = [&](double area) { return area > IsovalueErrors::least_share * all; };
  const auto large = static_cast<double>(std::count_if(areas.begin(), areas.end(), is_large));
  std::vector<double> found;
  for (const AreaPoint<D>& point : points) {
    const double part = areas[parts.part_of(point.c)];
    found.push_back(0.5 * point.area * (1 / all + (is_large(part) ? 1 / (part * large) : 0)));
  }
  return found;
}

// Computes the squared difference between a radiance and the mean of others as colors, summed over
// the channels. Subtracts the expected square that the noise of the mean adds.
double square_without_noise(const Vec<3, float>& radiance, const std::vector<Rgb>& others,
                            double exposure) {
  // Clamp, because a path that hits a lamp by chance may be a hundred times brighter.
  constexpr double brightest = 1.5;
  const auto count = static_cast<double>(others.size());
  double result = 0;
  for (int i = 0; i < 3; ++i) {
    double sum = 0, sum2 = 0;
    for (const Rgb& other : others) {
      const double one = std::min(brightest, exposure * other[i]);
      sum += one;
      sum2 += one * one;
    }
    const double mean = sum / count, color = std::min(1.0, exposure * radiance[i]);
    // Clip colors at white, where errors are invisible.
    if (mean > 1) {
      result += (color - 1) * (color - 1);
    } else {
      const double noise = (sum2 / count - mean * mean) / (count - 1);
      result += (color - mean) * (color - mean) - noise;
    }
  }
  return result / 3;
}

}  // namespace

template <int D>
MeasuredError<D>::MeasuredError(const LitScene<D>& scene, const std::vector<BakeTexels<D>>& texels)
    : scene_(scene), points_(texels.size()) {
  for (std::size_t v = 0; v < texels.size(); ++v) {
    if (scene.stores_light_of(v)) place(v, texels[v].shown.lattice);
  }
}

template <int D>
MeasuredError<D>::MeasuredError(const LitScene<D>& scene, const std::vector<AreaPoint<D>>& points)
    : scene_(scene), points_(1) {
  for (const AreaPoint<D>& point : points) points_[0].push_back({point, {}});
}

// Chooses points by systematic sampling along their order.
template <int D>
void MeasuredError<D>::place(std::size_t volume, const TexelLattice<D>& texels) {
  const std::vector<AreaPoint<D>> all =
      area_points(scene_.volumes[volume], texels, scene_.settings.seed);
  const std::vector<double> chance =
      chances(all, IsovalueErrors(scene_.tracer.scene().isovalue_range));
  const Affine<D>& to_frame = scene_.tracer.index_to_frame(static_cast<int>(volume));
  double passed = 0, next = 0.5;
  for (std::size_t i = 0; i < all.size(); ++i) {
    passed += chance[i] * points_a_volume;
    AreaPoint<D> chosen = all[i];
    chosen.area /= chance[i];
    for (; next < passed; ++next) {
      const Vec<D> position = to_frame.point(chosen.position);
      if (scene_.tracer.is_covered(static_cast<int>(volume), position, chosen.c)) continue;
      points_[volume].push_back({chosen, {}});
    }
  }
}

template <int D>
void MeasuredError<D>::trace(const std::vector<BakeTexels<D>>& texels, int estimates) {
  scene_.progress.begin("Measuring the error");
  std::vector<TexelLattice<D>> lattices;  // one per volume, for photons
  lattices.reserve(texels.size());
  for (const BakeTexels<D>& one : texels) {
    if (!scene_.plan.caustics) continue;
    lattices.push_back(one.indirect.lattice);
    lattices.back().drop_layers();
  }
  for (; estimates_ < estimates; ++estimates_) {
    // Prepare independent light, with new photons, for each estimate.
    const std::uint64_t seed = seed_of(estimates_);
    const PathLight<D> light(scene_, lattices, texels[0].photon_count, seed);
    for (std::size_t v = 0; v < points_.size(); ++v) {
      add(v, 0, this->estimates(light, seed, v, 0, points_[v].size()));
    }
  }
}

template <int D>
std::uint64_t MeasuredError<D>::seed_of(int estimate) const {
  return random_for(scene_.settings.seed, Purpose::measured_error, estimate).bits();
}

template <int D>
std::vector<Rgb> MeasuredError<D>::estimates(const PathLight<D>& light, std::uint64_t seed,
                                             std::size_t volume, std::size_t begin,
                                             std::size_t end) const {
  const int paths = paths_to_measure(scene_.settings.error);
  const PointSampler<D> from = light.sampler(scene_.lights);
  std::vector<Rgb> found(end - begin, Rgb(std::numeric_limits<Real>::quiet_NaN()));
  parallel_range(found.size(), 1, 0, scene_.progress, [&](std::size_t first, std::size_t last) {
    std::uint64_t rays = 0;
    for (std::size_t p = begin + first; p < begin + last; ++p) {
      const AreaPoint<D>& at = points_[volume][p].at;
      const SurfacePoint<D> point =
          scene_.tracer.isosurface_point(static_cast<int>(volume), at.at, at.c, false);
      if (point.kind() == HitKind::none || !(at.area > 0)) continue;
      // Average the paths of one estimate at the point.
      const SampleKeys keys =
          sample_keys(seed, Purpose::measured_error, volume, static_cast<std::uint32_t>(p));
      Imath::V3d sum(0);
      for (int i = 0; i < paths; ++i) {
        sum += Imath::V3d(from.direct(point, keys, i, rays) +
                          from.indirect(point, &light.estimator(), keys, i, rays));
      }
      found[p - begin] = Rgb(sum / paths);
    }
  });
  return found;
}

template <int D>
void MeasuredError<D>::add(std::size_t volume, std::size_t first,
                           const std::vector<Rgb>& radiances) {
  for (std::size_t i = 0; i < radiances.size(); ++i) {
    Point& point = points_[volume][first + i];
    if (std::isnan(radiances[i].x)) {
      point.at.area = 0;
    } else {
      point.radiance.push_back(radiances[i]);
    }
  }
}

template <int D>
void MeasuredError<D>::share(const Workers& workers) {
  if (estimates_ == most_estimates || !shared_.empty()) return;
  const std::size_t count = points_[0].size();
  workers.send(PartData::points, [&](std::ostream& stream) {
    std::vector<AreaPoint<D>> points;
    for (const Point& point : points_[0]) points.push_back(point.at);
    Archive archive(stream);
    archive(points, count);
  });
  std::vector<BakePart> parts;
  for (int estimate = estimates_; estimate < most_estimates; ++estimate) {
    BakePart of_estimate{PartKind::paths};
    of_estimate.number = estimate;
    add_parts(parts, of_estimate, count, points_a_part);
  }
  shared_ = SharedParts(workers, std::move(parts));
}

template <int D>
void MeasuredError<D>::take_shared() {
  if (shared_.empty()) return;
  scene_.progress.begin("Measuring the error");
  for (std::size_t i = 0; i < shared_.parts().size(); ++i) {
    const BakePart& part = shared_.parts()[i];
    std::optional<std::string> bytes = shared_.take(i, 0, scene_.progress);
    if (!bytes) bytes = traced(part);
    std::vector<Rgb> radiances(part.end - part.begin);
    copy_items(*bytes, radiances.data(), radiances.size());
    add(0, part.begin, radiances);
  }
  estimates_ = most_estimates;
  shared_ = {};
}

template <int D>
std::string MeasuredError<D>::traced(const BakePart& part) const {
  const std::uint64_t seed = seed_of(part.number);
  const PathLight<D> light(scene_, {}, 0, seed);
  return bytes_of(estimates(light, seed, 0, part.begin, part.end));
}

template <int D>
void MeasuredError<D>::add_to(IsovalueErrors& errors,
                              const std::vector<RadianceGrid<D>>& grids) const {
  for (std::size_t v = 0; v < points_.size(); ++v) {
    const Field<D>& field = scene_.volumes[v].volume().field;
    for (const Point& point : points_[v]) {
      if (!(point.at.area > 0)) continue;
      const Vec<3, float> radiance = radiance_at(grids[v], field, point.at.position, false);
      const double square =
          square_without_noise(radiance, point.radiance, scene_.settings.exposure);
      errors.add_measured(point.at.c, point.at.area, square);
    }
  }
}

template class MeasuredError<2>;
template class MeasuredError<3>;

}  // namespace leaflight

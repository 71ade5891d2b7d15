// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/indirect/direct_lookup.h"

#include <cmath>

#include "base/discrete_distribution.h"
#include "base/sampling.h"

namespace leaflight {
namespace {

// Chooses light points to represent all, each with its factor for the mean over the chosen ones.
// Returns all points if they are few. Otherwise the choice is by their light at the center.
template <int D>
std::vector<std::pair<std::size_t, double>> stand_ins(const DirectLight<D>& direct, int most) {
  std::vector<std::pair<std::size_t, double>> chosen;
  const std::size_t count = direct.points();
  if (count == 0) return chosen;
  std::vector<double> light(count);
  for (std::size_t i = 0; i < count; ++i) {
    const LightSource<D>& source = direct.point(i).source;
    const double distance = source.infinite ? 1 : source.position.length();
    const Vec<D> direction =
        source.infinite || !(distance > 0) ? source.direction : -source.position / distance;
    // The constant keeps points with a chance that shine away from the center.
    light[i] =
        average(source.amount) * (source.strength(direction, std::max(distance, 0.1)) + 0.05);
  }
  const DiscreteDistribution by_light(std::move(light));
  const int wanted = static_cast<int>(std::min<std::size_t>(count, most));
  for (int k = 0; k < wanted; ++k) {
    if (wanted == static_cast<int>(count)) {
      chosen.emplace_back(k, count);
    } else {
      const auto picked = by_light.pick((k + 0.5) / wanted);
      chosen.emplace_back(picked.index, 1 / picked.probability);
    }
  }
  return chosen;
}

}  // namespace

template <int D>
DirectLookup<D>::DirectLookup(const LineVolume<D>& volume, const TexelLattice<D>& lattice,
                              const DirectLight<D>& direct, Progress& progress)
    : code_{direct.code_range(), false} {
  const Field<D>& field = volume.volume().field;
  const Affine<D>& to_frame = volume.tracer.index_to_frame(volume.number);
  const Affine<D> to_index = inverse(to_frame);
  const auto chosen = stand_ins(direct, most_sources);
  for (const auto& [number, times] : chosen) {
    amounts_.push_back(direct.point(number).source.amount * static_cast<Real>(times));
    reflected_.emplace_back(lattice.active.size(), 0u);
  }
  parallel_range(lattice.active.size(), 4096, 0, progress, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const Vec<D> position = lattice.center(lattice.active[s]);
      const Vec<D> gradient =
          to_index.pull_back_gradient(shading_gradient(field, locate(field, position)));
      const double steep = gradient.length();
      if (!(steep > 0)) continue;
      const Vec<D> normal = gradient / -steep, place = to_frame.point(position);
      const TexelWeights<D> near = linear_weights(direct.lattice(), position);
      for (std::size_t k = 0; k < chosen.size(); ++k) {
        const LightSource<D>& source = direct.point(chosen[k].first).source;
        Vec<D> direction = source.direction;
        double distance = 1;
        if (!source.infinite) {
          direction = place - source.position;
          distance = direction.length();
          direction /= distance;
        }
        const double cosine = -direction.dot(normal);
        if (!(cosine > 0)) continue;
        const auto share = static_cast<float>(source.strength(direction, distance) * cosine /
                                              projected_hemisphere<D>);
        const float greatest = direct.greatest(chosen[k].first, near, false);
        std::uint32_t& packed = reflected_[k][s];
        std::memcpy(&packed, &share, sizeof share);
        packed = (packed & ~0xffu) | static_cast<std::uint32_t>(greatest);
      }
    }
  });
}

template class DirectLookup<2>;
template class DirectLookup<3>;

}  // namespace leaflight

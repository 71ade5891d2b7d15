// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/indirect/direct_lookup.h"

#include <cmath>

#include "base/discrete_distribution.h"
#include "base/sampling.h"
#include "field/cap_layers.h"

namespace leaflight {
namespace {

// A light point that represents others, and its factor for the mean over all of a choice.
struct StandIn {
  std::size_t point;
  double times;
};

// Returns choices of at most `most` light points each. A single choice has all points if they are
// few. Otherwise they are by their light at the center, and evenly different, so that the mean over
// all choices is that over all points.
template <int D>
std::vector<std::vector<StandIn>> stand_ins(const DirectLight<D>& direct, int most, int choices) {
  const std::size_t count = direct.points();
  std::vector<std::vector<StandIn>> found(1);
  if (count <= static_cast<std::size_t>(most)) {
    for (std::size_t i = 0; i < count; ++i) found[0].push_back({i, static_cast<double>(count)});
    return found;
  }
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
  found.resize(choices);
  for (int n = 0; n < choices; ++n) {
    for (int k = 0; k < most; ++k) {
      const auto picked = by_light.pick((k + (n + 0.5) / choices) / most);
      found[n].push_back({picked.index, 1 / picked.probability});
    }
  }
  return found;
}

}  // namespace

template <int D>
DirectLookup<D>::DirectLookup(const LineVolume<D>& volume, const TexelLattice<D>& lattice,
                              const DirectLight<D>& direct, Progress& progress)
    : code_{direct.code_range(), false} {
  const Field<D>& field = volume.volume().field;
  const Affine<D>& to_frame = volume.tracer.index_to_frame(volume.number);
  const Affine<D> to_index = inverse(to_frame);
  const auto choices = stand_ins(direct, most_sources, most_choices);
  choices_ = choices.size();
  for (const std::vector<StandIn>& chosen : choices) {
    for (const auto& [number, times] : chosen) {
      amounts_.push_back(direct.point(number).source.amount * static_cast<Real>(times));
    }
  }
  reflected_.assign(choices[0].size(), std::vector<std::uint32_t>(lattice.active.size(), 0u));
  parallel_each(lattice.active.size(), 4096, progress, [&](std::size_t s) {
    const Vec<D> position = slot_position(field, lattice, s);
    const Vec<D> gradient = to_index.pull_back_gradient(slot_gradient(field, lattice, s, position));
    const double steep = gradient.length();
    if (!(steep > 0)) return;
    const Vec<D> normal = gradient / -steep, place = to_frame.point(position);
    const TexelWeights<D> near = linear_weights(direct.lattice(), position);
    const std::vector<StandIn>& chosen = choices[choice(s)];
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      const LightSource<D>& source = direct.point(chosen[k].point).source;
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
      const float greatest = direct.greatest(chosen[k].point, near, false);
      std::uint32_t& packed = reflected_[k][s];
      std::memcpy(&packed, &share, sizeof share);
      packed = (packed & ~0xffu) | static_cast<std::uint32_t>(greatest);
    }
  });
}

template class DirectLookup<2>;
template class DirectLookup<3>;

}  // namespace leaflight

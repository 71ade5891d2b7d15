// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/isosurface_emitter.h"

#include <algorithm>
#include <cmath>

#include "base/sampling.h"

namespace leaflight {

template <int D>
IsosurfaceEmitter<D>::IsosurfaceEmitter(const SceneTracer<D>& tracer, int volume)
    : tracer_(tracer), volume_(volume) {
  const Volume<D>& scene_volume = tracer.scene().volumes[volume];
  if (!(scene_volume.emission.largest() > 0)) return;
  const double cell_volume = std::abs(determinant(tracer.index_to_frame(volume)));
  constexpr int size = 1 << IntervalPyramid<D>::log2_brick;
  const auto& level = scene_volume.field.pyramid->levels[0];
  const double height = tracer.scene().isovalue_range.height();
  const IsovalueRange isovalues = scene_volume.isovalues(tracer.scene().isovalue_range);
  Index<D> none{};
  std::vector<double> powers;
  for_each_index<D>(none, level.dims, [&](const Index<D>& index) {
    const Interval& interval = level.at(index);
    if (!(interval.min <= isovalues.max && interval.max >= isovalues.min)) return;
    Brick brick;
    for (int a = 0; a < D; ++a) {
      brick.low[a] = index[a] * size;
      brick.high[a] = std::min(brick.low[a] + size, scene_volume.field.dims[a] - 1);
    }
    double power = 0;
    for_each_index<D>(brick.low, brick.high, [&](const Index<D>& cell) {
      const CellPoint<D> middle{cell, Vec<D>(0.5)};
      const double h = interpolate(load_corners(scene_volume.field, cell), middle.local);
      if (std::isnan(h)) return;
      const SurfacePoint<D> p =
          tracer.isosurface_point(volume, middle, scene_volume.common_isovalue(h), false);
      if (p.kind() == HitKind::none) return;
      power += average(p.emission) * p.isosurface().gradient_length / height;
    });
    // A brick may emit even if the centers of its cells are dark.
    power = std::max(power, 1e-3 * scene_volume.emission.largest());
    powers.push_back(power * 2 * projected_hemisphere<D> * cell_volume);
    bricks_.push_back(brick);
  });
  by_power_ = DiscreteDistribution(std::move(powers));
}

template <int D>
typename IsosurfaceEmitter<D>::Sample IsosurfaceEmitter<D>::sample(double choice,
                                                                   Random& random) const {
  const auto picked = by_power_.pick(choice);
  const Brick& brick = bricks_[picked.index];
  const Volume<D>& scene_volume = tracer_.scene().volumes[volume_];
  Vec<D> position;
  double cells = 1;
  for (int a = 0; a < D; ++a) {
    const double size = brick.high[a] - brick.low[a];
    position[a] = brick.low[a] + size * random.uniform();
    cells *= size;
  }
  const bool back = random.uniform() < 0.5;
  const CellPoint<D> at = locate(scene_volume.field, position);
  const double h = interpolate(load_corners(scene_volume.field, at.cell), at.local);
  Sample sample{{}, Rgb(0)};
  if (std::isnan(h)) return sample;
  const double c = scene_volume.common_isovalue(h);
  if (!tracer_.scene().isovalue_range.contains(c)) return sample;
  sample.point = tracer_.isosurface_point(volume_, at, c, back);
  if (sample.point.kind() == HitKind::none) return sample;
  const double volume = cells * std::abs(determinant(tracer_.index_to_frame(volume_)));
  const double steepness =
      sample.point.isosurface().gradient_length / tracer_.scene().isovalue_range.height();
  sample.flux_height =
      sample.point.emission *
      static_cast<Real>(2 * projected_hemisphere<D> * volume * steepness / picked.probability);
  return sample;
}

template class IsosurfaceEmitter<2>;
template class IsosurfaceEmitter<3>;

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/seen_from_outside.h"

#include <tbb/parallel_for.h>

#include "base/low_discrepancy.h"
#include "base/random.h"
#include "base/sampling.h"
#include "field/given_point.h"
#include "trace/isosurface_ray.h"

namespace leaflight {
namespace {

template <int D>
bool is_seen_from_outside(const Field<D>& field, const Vec<D>& world, double isovalue,
                          int directions, std::uint64_t key) {
  const Vec<D> index = field.world_to_index.point(world);
  if (!holds_given(field, index)) return false;
  IsosurfaceRay<D> ray;
  ray.origin = locate(field, index);
  ray.position = ray.origin.index_position();
  ray.isovalue = isovalue;
  ray.starts_on_isosurface = true;
  const Vec<D> gradient = field.world_to_index.pull_back_gradient(
      geometric_gradient(load_corners(field, ray.origin.cell), ray.origin.local));
  if (!(gradient.length() > 0)) return false;
  const Vec<D> normal = -gradient.normalized();
  for (int i = 0; i < directions; ++i) {
    const Vec<D> direction = sample_cosine_hemisphere<D>(normal, sobol_point(i, key));
    ray.direction = field.world_to_index.vector(direction);
    if (!intersect(field, ray)) return true;
  }
  return false;
}

}  // namespace

template <int D>
std::vector<std::uint8_t> seen_from_outside(const Field<D>& field,
                                            const std::vector<Vec<D>>& points, double isovalue,
                                            int directions, std::uint64_t seed) {
  std::vector<std::uint8_t> result(points.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    Random random = random_for(seed, Purpose::seen_from_outside, i);
    result[i] = is_seen_from_outside(field, points[i], isovalue, directions, random.bits());
  });
  return result;
}

template std::vector<std::uint8_t> seen_from_outside<2>(const Field<2>&, const std::vector<Vec<2>>&,
                                                        double, int, std::uint64_t);
template std::vector<std::uint8_t> seen_from_outside<3>(const Field<3>&, const std::vector<Vec<3>>&,
                                                        double, int, std::uint64_t);

}  // namespace leaflight

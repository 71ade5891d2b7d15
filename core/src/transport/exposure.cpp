// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/transport/exposure.h"

#include <tbb/parallel_for.h>

#include "leaflight/math/low_discrepancy.h"
#include "leaflight/math/random.h"
#include "leaflight/math/sampling.h"
#include "leaflight/trace/leaf_ray.h"

namespace leaflight {
namespace {

bool is_exposed(const Field<3>& field, const Vec3& world, double isovalue, int directions,
                std::uint64_t key) {
  const Vec3 index = field.world_to_index.point(world);
  if (!inside(field, index)) return false;
  LeafRay<3> ray;
  ray.origin = locate(field, index);
  ray.position = ray.origin.index_position();
  ray.isovalue = isovalue;
  ray.starts_on_leaf = true;
  const Vec3 gradient = field.world_to_index.pull_back_gradient(
      geometric_gradient(load_corners(field, ray.origin.cell), ray.origin.local));
  if (!(gradient.length() > 0)) return false;
  const Vec3 normal = -gradient.normalized();
  for (int i = 0; i < directions; ++i) {
    const Vec3 direction = sample_cosine_hemisphere(normal, sobol_point(i, key));
    ray.direction = field.world_to_index.vector(direction);
    if (!intersect(field, ray)) return true;
  }
  return false;
}

}  // namespace

std::vector<std::uint8_t> exposed(const Field<3>& field, const std::vector<Vec3>& points,
                                  double isovalue, int directions, std::uint64_t seed) {
  std::vector<std::uint8_t> result(points.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    Random random = random_for(seed, Purpose::exposure, i);
    result[i] = is_exposed(field, points[i], isovalue, directions, random.bits());
  });
  return result;
}

}  // namespace leaflight

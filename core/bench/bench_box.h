// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "field/bump_box.h"
#include "scenes.h"

namespace leaflight::bench {

// Returns a scene of the bump box with n^3 nodes on the unit cube. All isovalues are lit.
inline Scene<3> bump_box_scene(int n) {
  Field<3> field = test::field_from<3>(bump_box<3>(n), {n, n, n}, test::unit_cube<3>(n));
  const IsovalueRange isovalue_range{field.min, field.max};
  return test::scene_of<3>(std::move(field), Rgb(0.75), isovalue_range);
}

// Returns index positions spread evenly over the box of a field, the same in every run.
inline std::vector<Vec3> random_positions(const Field<3>& field, std::size_t count) {
  Random random(1);
  std::vector<Vec3> positions(count);
  for (Vec3& position : positions) {
    for (int a = 0; a < 3; ++a) position[a] = random.uniform() * (field.dims[a] - 1);
  }
  return positions;
}

}  // namespace leaflight::bench

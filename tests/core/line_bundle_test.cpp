// SPDX-License-Identifier: GPL-3.0-or-later
#include "trace/line_bundle.h"

#include <gtest/gtest.h>

#include "fields.h"

namespace leaflight {
namespace {

// Expects lines to read the field's values wherever it is not empty. Some bundles are full; the
// last ones of a row are not.
void expect_values(int nodes, int voxels_per_texel, int spacing) {
  constexpr double below = 0.5;
  // The field is empty except for a ball in the last corner, where rows of bundles end.
  const Field<3> field =
      test::sampled<3>(nodes, [](const Vec3& x) { return 1 - 8 * (x - Vec3(1)).length(); });
  const EmptySpace<3> empty(field, below);
  const TexelLattice<3> lattice =
      make_lattice<3>(field, coarser_resolution<3>(field.dims, voxels_per_texel), below, 1.0);
  const LineSet<3> set = parallel_lines<3>(lattice, Vec3(0.02, 0.01, 1), spacing, {0.3, 0.6});
  const Planes<3> planes(field, lattice, set.axis);
  LineBundle<3> bundle(field, empty, lattice, set, planes);
  std::size_t checked = 0, skipped = 0;
  for (std::size_t row = 0; row < set.tracks[1].size(); ++row) {
    for (std::size_t i = 0; i < set.tracks[0].size(); i += LineBundle<3>::width) {
      bundle.follow({static_cast<int>(i), static_cast<int>(row)});
      for (int lane = 0; lane < bundle.lanes(); ++lane) {
        for (int k = bundle.first(lane); k <= bundle.last(lane); ++k) {
          const CellPoint<3> at =
              locate(field, bundle.position(lane, bundle.z(k)) * lattice.voxels_per_texel);
          const double h = interpolate(load_corners(field, at.cell), at.local);
          if (h >= below) {
            ASSERT_NEAR(bundle.value(k, lane), h, 1e-5);
            ++checked;
          } else {
            ASSERT_LT(bundle.value(k, lane), below + 1e-6);
            skipped += bundle.value(k, lane) == empty.value();
          }
        }
      }
    }
  }
  EXPECT_GT(checked, 0u);
  // Lines that are far apart read too many bricks for this test.
  if (voxels_per_texel == 1) {
    EXPECT_GT(skipped, checked);
  }
}

TEST(LineBundle, ReadsWhatIsNotEmpty) {
  for (int nodes = 61; nodes < 97; nodes += 4) {
    expect_values(nodes, 1, 1);
    expect_values(nodes, 1, 2);
    expect_values(nodes, 4, 1);
  }
}

}  // namespace
}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#include "trace/line_bundle.h"

#include <gtest/gtest.h>

#include "fields.h"

namespace leaflight {
namespace {

// All lines of a set read the field wherever it is not empty, in bundles that are full and in the
// last ones of their rows, which are not.
void expect_values(int nodes, int voxels_per_texel, int spacing) {
  constexpr double below = 0.5;
  // A ball in the last corner, where rows end; else empty.
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
  // Lines that are far apart ask for too many bricks.
  if (voxels_per_texel == 1) {
    EXPECT_GT(skipped, checked);
  }
}

// Of all crossings, also at the border, and beside masked voxels.
template <class Check>
void for_each_crossing(const Field<3>& field, int voxels_per_texel, Check check) {
  const double below = field.min - 1;
  const EmptySpace<3> empty(field, below);
  const TexelLattice<3> lattice =
      make_lattice<3>(field, coarser_resolution<3>(field.dims, voxels_per_texel), below, field.max);
  for (const Vec3& direction : {Vec3(0.2, 0.1, 1), Vec3(1, -0.3, 0.2), Vec3(-0.1, 1, 0.4)}) {
    const LineSet<3> set = parallel_lines<3>(lattice, direction, 1, {0.3, 0.6});
    const Planes<3> planes(field, lattice, set.axis);
    LineBundle<3> bundle(field, empty, lattice, set, planes);
    for (std::size_t row = 0; row < set.tracks[1].size(); ++row) {
      for (std::size_t i = 0; i < set.tracks[0].size(); i += LineBundle<3>::width) {
        bundle.follow({static_cast<int>(i), static_cast<int>(row)});
        for (int lane = 0; lane < bundle.lanes(); ++lane) {
          for (int k = bundle.first(lane); k <= bundle.last(lane); ++k) check(bundle, lane, k);
        }
      }
    }
  }
}

TEST(LineBundle, GradientsAreThoseOfShading) {
  const Field<3> whole = test::noise<3>(9, 5, 0.5);
  std::vector<float> values = test::values_of(whole);
  const std::vector<float> others(values.rbegin(), values.rend());
  values[whole.offset({3, 4, 8})] = std::nanf("");
  const Field<3> masked = test::field_from<3>(values, whole.dims, whole.index_to_world);
  Field<3> otherwise = whole;
  otherwise.shading_values = others.data();
  for (const Field<3>& field : {whole, masked, otherwise}) {
    for (const int voxels_per_texel : {1, 2}) {
      const double scale = static_cast<double>(field.dims[0] - 1) /
                           (coarser_resolution<3>(field.dims, voxels_per_texel)[0] - 1);
      const double unit = std::ldexp(1.0, std::ilogb(field.max - field.min));
      std::size_t found = 0;
      for_each_crossing(field, voxels_per_texel, [&](const auto& bundle, int lane, int plane) {
        if (std::isnan(bundle.value(plane, lane))) return;
        const Vec3 position = bundle.position(lane, bundle.z(plane)) * scale;
        const Vec3 expected = shading_gradient(field, locate(field, position));
        if (std::isnan(expected.length())) return;
        ++found;
        const Vec3 difference = Vec3(bundle.gradient(plane, lane)) * unit - expected;
        ASSERT_LT(difference.length(), 1e-5 * (field.max - field.min));
      });
      EXPECT_GT(found, 100u);
    }
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

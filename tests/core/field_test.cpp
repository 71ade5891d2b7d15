// SPDX-License-Identifier: GPL-3.0-or-later
#include "field/field.h"

#include <gtest/gtest.h>

#include <random>

#include "errors.h"
#include "field/bump_box.h"
#include "field/coarser_values.h"
#include "field/shading_gradient.h"
#include "field/texel_lattice.h"
#include "fields.h"

namespace leaflight {
namespace {

// Returns the bump box of thesis Eq. 2.1 and Table 2.1, computed independently of the core.
double bump_box_at(const std::vector<double>& x) {
  const double table[5][5] = {{0.0125, 0.036, 0.75, 0.60, 0.5},
                              {0.0200, 0.036, 0.60, 0.51, 0.5},
                              {0.0330, 0.036, 0.40, 0.50, 0.5},
                              {0.1670, 0.090, 0.50, 0.90, 0.5},
                              {1.6670, 1.350, 0.50, 1.50, 0.5}};
  double sum = 0;
  for (const auto& row : table) {
    double d2 = 0;
    for (std::size_t a = 0; a < x.size(); ++a) d2 += std::pow(x[a] - row[2 + a], 2);
    sum += row[0] / (row[1] * std::sqrt(2 * 3.14159265358979)) *
           std::exp(-d2 / std::pow(2 * row[1], 2));
  }
  return sum;
}

TEST(BumpBox, IsTheThesisFunction) {
  const auto values = bump_box<3>(21);
  // The raw range on a fine grid is 0.3378 to 1.209. This grid's own extremes are mapped to 0 and
  // 255.
  std::vector<double> raw;
  for_each_index<3>({0, 0, 0}, {21, 21, 21}, [&](const Index<3>& i) {
    raw.push_back(bump_box_at({i[0] / 20.0, i[1] / 20.0, i[2] / 20.0}));
  });
  const auto [low, high] = std::minmax_element(raw.begin(), raw.end());
  for (std::size_t i = 0; i < raw.size(); ++i) {
    ASSERT_NEAR(values[i], (raw[i] - *low) / (*high - *low) * 255, 1e-4);
  }
  EXPECT_NEAR(bump_box_at({0, 0, 0}), 0.3378, 5e-4);
  const auto flat = bump_box<2>(101);
  const auto peak = flat[50 * 101 + 40];  // the third bump, at (0.4, 0.5)
  EXPECT_GT(peak, flat[50 * 101 + 50]);
}

TEST(IntervalPyramid, BoundsEveryBrick) {
  const Field<3> field = test::noise<3>(23, 3, 0.5);
  for (std::size_t level = 0; level < field.pyramid->levels.size(); ++level) {
    const auto& bricks = field.pyramid->levels[level];
    const int size = 1 << (2 * (static_cast<int>(level) + 1));
    for_each_index<3>({0, 0, 0}, bricks.dims, [&](const Index<3>& b) {
      if (bricks.at(b).min > bricks.at(b).max) return;  // no cells
      Index<3> first, end;
      for (int a = 0; a < 3; ++a) {
        first[a] = b[a] * size;
        end[a] = std::min(22, (b[a] + 1) * size) + 1;
      }
      float low = 1e9f, high = -1e9f;
      for_each_index<3>(first, end, [&](const Index<3>& voxel) {
        low = std::min(low, field.value(voxel));
        high = std::max(high, field.value(voxel));
      });
      ASSERT_EQ(bricks.at(b).min, low);
      ASSERT_EQ(bricks.at(b).max, high);
    });
  }
  EXPECT_EQ(field.pyramid->levels.back().bricks.size(), 1u);
}

TEST(Field, GradientsOfALinearFunctionAreExact) {
  const Field<3> field =
      test::sampled<3>(9, [](const Vec3& x) { return 8 * (2 * x.x - 3 * x.y + 0.5 * x.z); });
  const CellPoint<3> p = locate(field, {0.3, 4.9, 8.0});
  for (const Vec3& g :
       {geometric_gradient(load_corners(field, p.cell), p.local), shading_gradient(field, p)}) {
    EXPECT_LT((g - Vec3(2, -3, 0.5)).length(), 1e-5);
  }
}

TEST(Field, ShadingGradientIsContinuousAcrossFaces) {
  const Field<3> field = test::noise<3>(9, 1, 0.5);
  const CellPoint<3> below{{3, 4, 4}, {1.0, 0.3, 0.6}}, above{{4, 4, 4}, {0.0, 0.3, 0.6}};
  EXPECT_LT((shading_gradient(field, below) - shading_gradient(field, above)).length(), 1e-12);
}

TEST(CoarserValues, AreThoseOfALinearFunctionOverTheSameDomain) {
  const auto h = [](const Vec3& index) { return 3 + index.dot(Vec3(0.5, -2.0, 7.0)); };
  const Index<3> dims{9, 4, 8}, coarse{5, 3, 5};
  std::vector<float> values;
  for_each_index<3>({0, 0, 0}, dims, [&](const Index<3>& i) {
    values.push_back(static_cast<float>(h(to_vector<3>(i))));
  });
  const float hole = std::numeric_limits<float>::quiet_NaN();
  values[(7 * 4 + 0) * 9 + 5] = hole;
  const Field<3> field = test::field_from<3>(values, dims, test::unit_cube<3>(2));
  const std::vector<float> coarser = coarser_values(field);
  ASSERT_EQ(coarser.size(), cell_count<3>(coarse));
  for (std::size_t voxel = 0; voxel < coarser.size(); ++voxel) {
    const Index<3> i = index_of<3>(voxel, coarse);
    if ((i[0] == 2 || i[0] == 3) && i[1] < 2 && i[2] > 2) {
      EXPECT_TRUE(std::isnan(coarser[voxel]));
    } else {
      EXPECT_NEAR(coarser[voxel], h(Vec3(2 * i[0], 1.5 * i[1], 1.75 * i[2])), 1e-5);
    }
  }
}

TEST(CoarserValues, AreMeansOverTwoVoxels) {
  std::vector<float> values(5 * 5 * 5);
  const Index<3> dims{5, 5, 5};
  values[linear_number<3>({2, 3, 0}, dims)] = 16;
  const std::vector<float> coarser =
      coarser_values(test::field_from<3>(values, dims, test::unit_cube<3>(2)));
  for (std::size_t voxel = 0; voxel < coarser.size(); ++voxel) {
    const Index<3> i = index_of<3>(voxel, {3, 3, 3});
    const bool is_beside = i == Index<3>{1, 1, 0};
    EXPECT_EQ(coarser[voxel], is_beside ? 1.5f : 0);
  }
}

TEST(Field, ShadesByOtherValues) {
  const Field<3> field = test::noise<3>(7, 1, 0.5), other = test::noise<3>(7, 2, 0.5);
  Field<3> mixed = field;
  mixed.shading_values = other.shading_values;
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    const Vec3 p(6 * random.uniform(), 6 * random.uniform(), 6 * random.uniform());
    const Vec3 expected = shading_gradient(other, locate(other, p));
    EXPECT_EQ((shading_gradient(mixed, locate(mixed, p)) - expected).length(), 0);
    EXPECT_EQ(value_at(mixed, p), value_at(field, p));
  }
}

TEST(Field, RefusesWhatHasNoIsosurface) {
  const auto expect_refused = [](const std::string& words, const std::vector<float>& values,
                                 const Index<3>& dims, const Affine<3>& transform) {
    test::expect_refused(words, [&] { test::field_from<3>(values, dims, transform); });
  };
  const Affine<3> m = test::unit_cube<3>(2);
  std::vector<float> ramp{0, 1, 2, 3, 4, 5, 6, 7};
  EXPECT_NO_THROW(test::field_from<3>(ramp, {2, 2, 2}, m));
  // A variation of 1e-3 near 1e6 is below single precision.
  const std::vector<float> rounded(8, static_cast<float>(1e6 + 1e-3));
  expect_refused("same value 1e+06 in single precision", rounded, {2, 2, 2}, m);
  expect_refused("NaN", std::vector<float>(8, std::nanf("")), {2, 2, 2}, m);
  for (const float infinite : {HUGE_VALF, -HUGE_VALF}) {
    ramp[3] = infinite;
    expect_refused("infinite", ramp, {2, 2, 2}, m);
  }
  expect_refused("axis y", ramp, {8, 1, 1}, m);
  Affine<3> flat = m;
  flat.column[2] = Vec3(0.0);
  ramp[3] = 3;
  expect_refused("inverted", ramp, {2, 2, 2}, flat);
}

TEST(TexelLattice, HoldsEveryTexelThatALookupNeeds) {
  const Field<3> field = test::ball<3>(21);
  const TexelLattice<3> lattice = make_lattice(field, {21, 21, 21}, 0.7, 0.8);
  EXPECT_EQ(active_texels(field, {21, 21, 21}, 0.7, 0.8), lattice.active.size());
  Random random(3);
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 p(20 * random.uniform(), 20 * random.uniform(), 20 * random.uniform());
    const CellPoint<3> point = locate(field, p);
    const double h = interpolate(load_corners(field, point.cell), point.local);
    if (h < 0.7 || h > 0.8) continue;
    ASSERT_EQ(linear_weights(lattice, p).count, 8);
  }
}

// Compares with the definition, for texels of all widths, several types, and voxels without data.
TEST(TexelLattice, ActiveTexelsAreThoseThatIsosurfacesReach) {
  const Index<3> dims{9, 7, 6};
  std::vector<float> values(9 * 7 * 6);
  std::mt19937 random(3);
  for (float& h : values) h = random() % 40 ? 1.0f : static_cast<float>(random() % 50);
  std::vector<std::uint8_t> integers(values.begin(), values.end());
  for (std::size_t i = 0; i < values.size(); i += 7) values[i] = std::nanf("");
  const double low = 20, high = 30;
  const auto expect_active = [&](const Field<3>& field, const Index<3>& resolution) {
    const TexelLattice<3> lattice = make_lattice(field, resolution, low, high);
    std::vector<std::uint32_t> expected;
    for (std::uint32_t texel = 0; texel < cell_count<3>(resolution); ++texel) {
      const Vec3 center = lattice.center(texel);
      float min = 1e9f, max = -1e9f;
      for (std::size_t v = 0; v < field.voxels(); ++v) {
        const Vec3 away = to_vector<3>(index_of<3>(v, dims)) - center;
        bool near = true;
        for (int a = 0; a < 3; ++a) {
          // Voxels within one texel, and the first ones beyond.
          near = near && std::abs(away[a]) < lattice.voxels_per_texel[a] + 1 - 1e-9;
        }
        const float h = value_at(field.values, v);
        if (!near || std::isnan(h)) continue;
        min = std::min(min, h), max = std::max(max, h);
      }
      if (min < max && min < high && max >= low) expected.push_back(texel);
    }
    EXPECT_EQ(lattice.active, expected);
    EXPECT_EQ(active_texels(field, resolution, low, high), expected.size());
    EXPECT_GT(expected.size(), 0u);
    EXPECT_LT(expected.size(), cell_count<3>(resolution));
  };
  for (const Index<3>& resolution : {Index<3>{9, 7, 6}, {17, 13, 11}, {5, 4, 3}, {10, 3, 8}}) {
    expect_active(make_field<3>(values.data(), dims, test::unit_cube<3>(9), nullptr), resolution);
    expect_active(make_field<3>(integers.data(), dims, test::unit_cube<3>(9), nullptr), resolution);
  }
}

}  // namespace
}  // namespace leaflight

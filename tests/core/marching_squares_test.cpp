// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/marching_squares.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/sampling.h"
#include "fields.h"

namespace leaflight {
namespace {

using Point = Vec<2>;

struct Degrees {
  std::vector<int> in, out;
};

Degrees degrees(const IsolineMesh& mesh) {
  Degrees d{std::vector<int>(mesh.vertices.size()), std::vector<int>(mesh.vertices.size())};
  for (const auto& s : mesh.segments) ++d.out[s[0]], ++d.in[s[1]];
  return d;
}

// True if every vertex has one segment in and one out.
bool closed(const IsolineMesh& mesh) {
  const Degrees d = degrees(mesh);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (d.in[v] != 1 || d.out[v] != 1) return false;
  }
  return true;
}

double length(const IsolineMesh& mesh) {
  double sum = 0;
  for (const auto& s : mesh.segments) {
    sum += (Point(mesh.vertices[s[1]]) - Point(mesh.vertices[s[0]])).length();
  }
  return sum;
}

// Returns the enclosed area; positive if the inside is on the right of the segments.
double enclosed_area(const IsolineMesh& mesh) {
  double area = 0;
  for (const auto& s : mesh.segments) {
    area -= Point(mesh.vertices[s[0]]).cross(Point(mesh.vertices[s[1]])) / 2;
  }
  return area;
}

TEST(MarchingSquares, Circle) {
  const IsolineMesh mesh = contour(test::ball<2>(41), 0.7);
  EXPECT_TRUE(closed(mesh));
  EXPECT_NEAR(length(mesh), 2 * pi * 0.3, 0.01 * 2 * pi * 0.3);
  EXPECT_NEAR(enclosed_area(mesh), pi * 0.09, 0.01 * pi * 0.09);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Point p = Point(mesh.vertices[v]) - Point(0.5);
    EXPECT_NEAR(p.length(), 0.3, 1e-3);
    EXPECT_GT(p.normalized().dot(Point(mesh.normals[v])), 0.99);
  }
}

// All sign patterns occur many times, alternating squares among them.
TEST(MarchingSquares, NoiseIsClosed) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const IsolineMesh mesh = contour(test::noise<2>(40, seed, -1.0), 0.5);
    EXPECT_GT(mesh.segments.size(), 1000u);
    EXPECT_TRUE(closed(mesh)) << "seed " << seed;
    EXPECT_GT(enclosed_area(mesh), 0) << "seed " << seed;
  }
}

Field<2> square(float h00, float h10, float h01, float h11) {
  return test::field_from<2>({h00, h10, h01, h11}, {2, 2}, test::unit_cube<2>(2));
}

// Where the saddle of the bilinear interpolant is above, the higher corners are connected.
TEST(MarchingSquares, SaddlesFollowTheBilinearInterpolant) {
  Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const auto u = [&] { return static_cast<float>(random.uniform()); };
    const bool first_above = random.uniform() < 0.5;
    const float a = 0.5f + u(), b = 0.5f + u(), low_a = 0.49f - u(), low_b = 0.49f - u();
    const Field<2> field = first_above ? square(a, low_a, low_b, b) : square(low_a, a, b, low_b);
    const IsolineMesh mesh = contour(field, 0.5);
    ASSERT_EQ(mesh.vertices.size(), 4u);
    ASSERT_EQ(mesh.segments.size(), 2u);
    const CellCorners<2> corners = load_corners<2>(field, {0, 0});
    const double saddle = (corners.h[0] * corners.h[3] - corners.h[1] * corners.h[2]) /
                          (corners.h[0] + corners.h[3] - corners.h[1] - corners.h[2]);
    if (std::abs(saddle - 0.5) < 1e-3) continue;
    // Each segment then cuts off a lower corner.
    for (const auto& s : mesh.segments) {
      const Point from(mesh.vertices[s[0]]), to(mesh.vertices[s[1]]);
      int cut = 0;
      for (int a2 = 0; a2 < 2; ++a2) {
        const bool high_end = from[a2] == 1 || to[a2] == 1;
        EXPECT_NE(high_end, from[a2] == 0 || to[a2] == 0);
        cut |= static_cast<int>(high_end) << a2;
      }
      EXPECT_EQ(corners.h[cut] < 0.5, saddle >= 0.5);
    }
  }
}

// A value equal to the isovalue counts as above it, at corners and at the saddle.
TEST(MarchingSquares, TiesCountAsAbove) {
  EXPECT_TRUE(contour(square(1, 1, 1, 2), 1.0).segments.empty());
  EXPECT_EQ(contour(square(1, 0, 1, 1), 1.0).segments.size(), 1u);
  const IsolineMesh mesh = contour(square(1, -1, -1, 1), 0.0);  // the saddle is 0
  ASSERT_EQ(mesh.segments.size(), 2u);
  for (const auto& s : mesh.segments) {
    const Point middle = (Point(mesh.vertices[s[0]]) + Point(mesh.vertices[s[1]])) / 2;
    EXPECT_LT((middle.x - 0.5) * (middle.y - 0.5), 0);  // lines go around the lower corners
  }
}

TEST(MarchingSquares, OpenAtTheBorder) {
  const IsolineMesh mesh =
      contour(test::sampled<2>(17, [](const Point& x) { return x.y + 0.1 * x.x; }), 0.5);
  const Degrees d = degrees(mesh);
  int starts = 0, ends = 0;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const float x = mesh.vertices[v].x;
    starts += d.in[v] == 0;
    ends += d.out[v] == 0;
    // The inside, which is above, must be on the right.
    if (d.in[v] == 0) {
      EXPECT_EQ(x, 1);
    }
    if (d.out[v] == 0) {
      EXPECT_EQ(x, 0);
    }
  }
  EXPECT_EQ(starts, 1);
  EXPECT_EQ(ends, 1);
  EXPECT_NEAR(length(mesh), std::hypot(1, 0.1), 1e-5);
}

TEST(MarchingSquares, MirroredTransformKeepsTheOrientation) {
  const Field<2> field = test::ball<2>(21);
  Affine<2> mirrored = field.index_to_world;
  mirrored.column[0] = -mirrored.column[0];
  const auto copy = make_field<2>(field.values, field.dims, mirrored, field.owner);
  EXPECT_NEAR(enclosed_area(contour(copy, 0.7)), pi * 0.09, 0.02 * pi * 0.09);
}

TEST(MarchingSquares, MaskedCellsLeaveAGap) {
  const Field<2> whole = test::ball<2>(21);
  std::vector<float> values = test::values_of(whole);
  values[whole.offset({10, 16})] = std::nanf("");
  const auto field = test::field_from<2>(values, whole.dims, whole.index_to_world);
  const IsolineMesh mesh = contour(field, 0.7);
  EXPECT_EQ(mesh.segments.size() + 2, contour(whole, 0.7).segments.size());
  EXPECT_EQ(mesh.vertices.size(), mesh.segments.size() + 1);
}

TEST(MarchingSquares, NothingOutsideTheData) {
  EXPECT_TRUE(contour(test::ball<2>(9), 5.0).segments.empty());
}

}  // namespace
}  // namespace leaflight

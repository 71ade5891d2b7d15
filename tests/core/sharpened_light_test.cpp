// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the sharpening of light that lines look up.
#include "bake/indirect/sharpened_light.h"

#include <gtest/gtest.h>

#include "agreement.h"
#include "base/random.h"

namespace leaflight {
namespace {

Progress ignored;
constexpr int nodes = 9;

template <int D>
IndexedLattice<D> texels_of_slope(double highest) {
  const auto field = test::sampled<D>(nodes, [](const Vec<D>& x) { return x[0]; });
  return IndexedLattice<D>(make_lattice(field, field.dims, 0, highest));
}

template <int D, class Light>
std::vector<Rgb> light_of(const IndexedLattice<D>& texels, Light light) {
  std::vector<Rgb> values;
  for (const std::uint32_t texel : texels.lattice.active) {
    values.emplace_back(static_cast<Real>(light(texels.lattice.center(texel))));
  }
  return values;
}

template <int D>
bool is_inside(const TexelLattice<D>& lattice, std::uint32_t number) {
  const Index<D> texel = lattice.texel(number);
  return *std::min_element(texel.begin(), texel.end()) > 0 &&
         *std::max_element(texel.begin(), texel.end()) < nodes - 1;
}

// The second differences are 2 along each axis. A mean over a texel adds 1/24 of each, and linear
// interpolation adds 1/12 of each on average.
template <int D>
void expect_sharp_squares() {
  const IndexedLattice<D> texels = texels_of_slope<D>(1);
  const auto squares = [](const Vec<D>& x) { return 3 + x.dot(x) + 0.5 * x[0] * x[1]; };
  const std::vector<Rgb> means =
      light_of(texels, [&](const Vec<D>& x) { return squares(x) + 2.0 * D / 24; });
  const std::vector<Rgb> sharp = sharpened(texels, means, ignored);
  for (std::size_t s = 0; s < sharp.size(); ++s) {
    const std::uint32_t texel = texels.lattice.active[s];
    if (!is_inside(texels.lattice, texel)) continue;
    EXPECT_NEAR(sharp[s].x + 2.0 * D / 12, squares(texels.lattice.center(texel)), 1e-4) << s;
  }
}

TEST(SharpenedLight, IsThatBeforeTheMeanOverATexelAndInterpolation) {
  expect_sharp_squares<2>();
  expect_sharp_squares<3>();
}

TEST(SharpenedLight, IsTheSameIfItIsLinearUpToTheEdges) {
  const IndexedLattice<3> texels = texels_of_slope<3>(0.6);
  const std::vector<Rgb> linear =
      light_of(texels, [](const Vec3& x) { return 5 - x.x + 2 * x.y + 0.3 * x.z; });
  const std::vector<Rgb> sharp = sharpened(texels, linear, ignored);
  ASSERT_FALSE(sharp.empty());
  for (std::size_t s = 0; s < sharp.size(); ++s) EXPECT_NEAR(sharp[s].x, linear[s].x, 1e-5);
}

TEST(SharpenedLight, KeepsTheMeanOfNoise) {
  const IndexedLattice<3> texels = texels_of_slope<3>(1);
  Random random(3, 1, 1);
  // Noise at inner texels alone: those at the edges have fewer neighbors.
  std::vector<Rgb> noise = light_of(texels, [&](const Vec3& x) {
    for (int a = 0; a < 3; ++a) {
      if (x[a] < 1.5 || x[a] > nodes - 2.5) return 0.0;
    }
    return random.uniform() < 0.1 ? 10.0 : 0.0;
  });
  const std::vector<Rgb> sharp = sharpened(texels, noise, ignored);
  double before = 0, after = 0, least = 0;
  for (std::size_t s = 0; s < noise.size(); ++s) {
    before += noise[s].x;
    after += sharp[s].x;
    least = std::min<double>(least, sharp[s].x);
  }
  ASSERT_GT(before, 50);
  EXPECT_NEAR(after / before, 1, 0.02);
  EXPECT_LT(least, 0);
}

}  // namespace
}  // namespace leaflight

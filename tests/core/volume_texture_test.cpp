// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/volume_texture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace leaflight {
namespace {

// A channel of 3 x 2 x 2 voxels, whose values are 1 + x + 10 y + 100 z.
std::vector<float> linear_values() {
  std::vector<float> values;
  for (int i = 0; i < 12; ++i) {
    values.push_back(static_cast<float>(1 + i % 3 + 10 * (i / 3 % 2) + 100 * (i / 6)));
  }
  return values;
}

// Colors equal to values / 200, so that they show the interpolated value.
ColorRamp shares() { return ColorRamp({{0, Rgb(0)}, {200, Rgb(1)}}); }

VolumeTexture<3> texture_of(const std::vector<float>& values, bool nearest = false) {
  VolumeTexture<3> texture;
  texture.channels = {{values.data(), nullptr}};
  texture.dims = {3, 2, 2};
  texture.to_texture = {{Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)}, Vec3(0)};
  texture.colors = shares();
  texture.nearest = nearest;
  return texture;
}

TEST(VolumeTexture, InterpolatesLinearValuesExactly) {
  const std::vector<float> values = linear_values();
  const VolumeTexture<3> texture = texture_of(values);
  for (const Vec3& at : {Vec3(0, 0, 0), Vec3(1.25, 0.5, 0.75), Vec3(2, 1, 1)}) {
    EXPECT_NEAR(texture.at(at).x, (1 + at.x + 10 * at.y + 100 * at.z) / 200, 1e-6);
  }
}

TEST(VolumeTexture, TransformsIndexPositions) {
  const std::vector<float> values = linear_values();
  VolumeTexture<3> texture = texture_of(values);
  texture.to_texture = {{Vec3(0, 0.5, 0), Vec3(2, 0, 0), Vec3(0, 0, 1)}, Vec3(0.5, 0, 0)};
  // The position (1, 0.25, 0.5) lies at (0.5 + 2 * 0.25, 0.5 * 1, 0.5) of the texture.
  EXPECT_NEAR(texture.at(Vec3(1, 0.25, 0.5)).x, (1 + 1 + 10 * 0.5 + 100 * 0.5) / 200, 1e-6);
}

TEST(VolumeTexture, NearestNeverMixesValues) {
  const std::vector<float> values = linear_values();
  const VolumeTexture<3> texture = texture_of(values, true);
  EXPECT_NEAR(texture.at(Vec3(0.49, 0.49, 0.49)).x, 1.0 / 200, 1e-6);
  EXPECT_NEAR(texture.at(Vec3(0.51, 0.51, 0.51)).x, 112.0 / 200, 1e-6);
}

TEST(VolumeTexture, WithoutAValueItIsWhite) {
  std::vector<float> values = linear_values();
  values[0] = std::numeric_limits<float>::quiet_NaN();
  const VolumeTexture<3> texture = texture_of(values);
  EXPECT_EQ(texture.at(Vec3(0.5, 0, 0)), Rgb(1));
  EXPECT_NE(texture.at(Vec3(1.5, 0, 0)), Rgb(1));
  // A cap lies up to a third of a voxel outside the data.
  EXPECT_NEAR(texture.at(Vec3(2.4, 1, 1)).x, 113.0 / 200, 1e-6);
  EXPECT_EQ(texture.at(Vec3(2.6, 1, 1)), Rgb(1));
  EXPECT_EQ(texture.at(Vec3(std::nan(""), 0, 0)), Rgb(1));
}

TEST(VolumeTexture, ThreeChannelsAreRedGreenAndBlue) {
  const std::vector<float> red(12, 200), green(12, 100), blue(12, 0);
  VolumeTexture<3> texture = texture_of(red);
  texture.channels = {{red.data(), nullptr}, {green.data(), nullptr}, {blue.data(), nullptr}};
  const Rgb color = texture.at(Vec3(1.5, 0.5, 0.5));
  EXPECT_NEAR(color.x, 1, 1e-6);
  EXPECT_NEAR(color.y, 0.5, 1e-6);
  EXPECT_NEAR(color.z, 0, 1e-6);
}

}  // namespace
}  // namespace leaflight

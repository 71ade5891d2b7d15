// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/walls/smooth_walls.h"

#include <gtest/gtest.h>

#include <random>

namespace leaflight {
namespace {

Progress ignored;

constexpr float noise = 0.1f;  // standard deviation of the mean of both halves
constexpr int nodes = 2;

// Returns a square of the plane z = 0 in about 16,000 pieces.
FineMesh<3> square() {
  Mesh<3> mesh;
  for (const Vec3& corner : {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)}) {
    mesh.vertices.emplace_back(corner);
  }
  mesh.facets = {{0, 1, 2}, {0, 2, 3}};
  Scene<3> scene;
  scene.meshes = {mesh};
  return subdivide(scene)[0].coarse;
}

template <class Truth>
Halves noisy(const FineMesh<3>& mesh, float deviation, Truth truth) {
  std::mt19937 bits(7);
  std::normal_distribution<float> error(0, 1);
  Halves halves;
  for (auto& half : halves) {
    for (int node = 0; node < nodes; ++node) {
      for (const auto& vertex : mesh.vertices) {
        const float drawn = truth(vertex, node) + deviation * std::sqrt(2.0f) * error(bits);
        half.emplace_back(drawn, 2 * drawn, 0.0f);
      }
    }
  }
  return halves;
}

// Returns the RMS error of the red channel over the vertices that `counts` accepts.
template <class Truth, class Counts>
float rms(const FineMesh<3>& mesh, const std::vector<Vec<3, float>>& radiance, Truth truth,
          Counts counts) {
  double sum = 0;
  int number = 0;
  for (std::size_t i = 0; i < radiance.size(); ++i) {
    const auto& vertex = mesh.vertices[i % mesh.vertices.size()];
    if (!counts(vertex)) continue;
    const double off = radiance[i].x - truth(vertex, static_cast<int>(i / mesh.vertices.size()));
    sum += off * off;
    ++number;
  }
  return static_cast<float>(std::sqrt(sum / number));
}

TEST(SmoothWalls, TakesThreeQuartersOfTheNoiseAwayWhereLightIsEven) {
  const FineMesh<3> mesh = square();
  const auto slope = [](const auto& x, int node) { return 1 + 0.5f * x.x + node; };
  const auto radiance = mean(smooth(mesh, noisy(mesh, noise, slope), 3, ignored));
  EXPECT_LT(rms(mesh, radiance, slope, [](const auto&) { return true; }), 0.25f * noise);
}

TEST(SmoothWalls, KeepsTheEdgeOfAShadow) {
  const FineMesh<3> mesh = square();
  const auto shadow = [](const auto& x, int) { return x.x < 0.5f ? 1.0f : 0.2f; };
  const auto radiance = mean(smooth(mesh, noisy(mesh, noise, shadow), 3, ignored));
  const auto beside = [](const auto& x) { return std::abs(x.x - 0.5f) < 0.03f; };
  EXPECT_LT(rms(mesh, radiance, shadow, beside), 0.6f * noise);
}

TEST(SmoothWalls, LeavesWhatHasNoNoise) {
  const FineMesh<3> mesh = square();
  const auto waves = [](const auto& x, int node) { return 2 + std::sin(40 * x.x) + node * x.y; };
  const Halves halves = noisy(mesh, 0, waves);
  const auto radiance = mean(smooth(mesh, halves, 3, ignored));
  for (std::size_t i = 0; i < radiance.size(); ++i) {
    EXPECT_NEAR(radiance[i].x, halves[0][i].x, 1e-6f);
  }
}

}  // namespace
}  // namespace leaflight

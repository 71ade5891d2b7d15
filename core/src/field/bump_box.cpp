// SPDX-License-Identifier: GPL-3.0-or-later
#include "field/bump_box.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "base/sampling.h"

namespace leaflight {
namespace {

struct Bump {
  double a, sigma;
  std::array<double, 3> p;
};

constexpr std::array<Bump, 5> bumps{{{0.0125, 0.036, {0.75, 0.60, 0.5}},
                                     {0.0200, 0.036, {0.60, 0.51, 0.5}},
                                     {0.0330, 0.036, {0.40, 0.50, 0.5}},
                                     {0.1670, 0.090, {0.50, 0.90, 0.5}},
                                     {1.6670, 1.350, {0.50, 1.50, 0.5}}}};

}  // namespace

template <int D>
std::vector<float> bump_box(int n) {
  if (n < 2 || n > 2048) {
    throw Error("The bump box needs between 2 and 2048 voxels along each axis, not " +
                std::to_string(n) + "; choose another size.");
  }
  // The bumps are separable, so use a table of exponentials per bump and axis.
  std::vector<double> table(bumps.size() * D * n);
  const auto factor = [&](std::size_t b, int axis, int i) -> double& {
    return table[(b * D + axis) * n + i];
  };
  for (std::size_t b = 0; b < bumps.size(); ++b) {
    for (int axis = 0; axis < D; ++axis) {
      for (int i = 0; i < n; ++i) {
        const double d = static_cast<double>(i) / (n - 1) - bumps[b].p[axis];
        const double s = 2 * bumps[b].sigma;
        factor(b, axis, i) = std::exp(-d * d / (s * s));
      }
    }
  }
  std::size_t voxels = 1;
  for (int a = 0; a < D; ++a) voxels *= n;
  std::vector<double> raw(voxels);
  for (std::size_t v = 0; v < voxels; ++v) {
    double sum = 0;
    for (std::size_t b = 0; b < bumps.size(); ++b) {
      double g = bumps[b].a / (bumps[b].sigma * std::sqrt(2 * pi));
      std::size_t rest = v;
      for (int axis = 0; axis < D; ++axis, rest /= n) g *= factor(b, axis, rest % n);
      sum += g;
    }
    raw[v] = sum;
  }
  const auto [low, high] = std::minmax_element(raw.begin(), raw.end());
  const double offset = *low, scale = 255.0 / (*high - *low);
  std::vector<float> values(voxels);
  std::transform(raw.begin(), raw.end(), values.begin(),
                 [&](double h) { return static_cast<float>((h - offset) * scale); });
  return values;
}

template std::vector<float> bump_box<2>(int);
template std::vector<float> bump_box<3>(int);

}  // namespace leaflight

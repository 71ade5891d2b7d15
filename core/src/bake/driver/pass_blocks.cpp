// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/pass_blocks.h"

#include <algorithm>
#include <cmath>

namespace leaflight {
namespace {

// Upper bound on the number of blocks of a bake.
constexpr int most_blocks = 32;
// Bakes with fewer texels begin with four blocks, which are quick.
constexpr std::size_t few_texels = 1'500'000;
// Bounds of the noise to reach, as a share of the target error. If the bias leaves less
// than the lower bound, passes would take several times as long for almost no gain. Then the noise
// to reach is a share of the bias.
constexpr double least_noise = 0.4, most_noise = 0.8, out_of_reach_noise = 0.5;

// Returns the noise that an error leaves beside its bias.
double noise_beside(double error, double bias) {
  return std::sqrt(std::max(0.0, error * error - bias * bias));
}

}  // namespace

bool is_out_of_reach(double error, double bias) {
  return noise_beside(error, bias) < least_noise * error;
}

double noise_to_reach(double error, double bias) {
  if (is_out_of_reach(error, bias)) return out_of_reach_noise * bias;
  return std::min(noise_beside(error, bias), most_noise * error);
}

int first_blocks(std::size_t texels) { return texels < few_texels ? 4 : 2; }

int next_blocks(int now, double noise, double target) {
  if (now == 0) return 0;
  const double wanted = noise * now / target;
  const int most = std::max(now, std::min(std::max(2 * now, 8), most_blocks));
  // A small pass has the same overhead as a large one, so passes grow by at least a quarter.
  const double grown = wanted > now ? std::max(std::ceil(wanted), std::ceil(1.25 * now)) : now;
  return static_cast<int>(std::clamp<double>(grown, now, most));
}

}  // namespace leaflight

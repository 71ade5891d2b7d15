// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/pass_schedule.h"

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

// A bake of more texels shows a first picture.
constexpr std::size_t most_without_preview = 200'000;
// Predicted ratio of the walls' time in a complete pass to that in the first picture: for shadow
// rays and for samples.
constexpr int more_ways = 6, more_samples = 3;
// A pass that runs out of time ends after at least this many blocks.
constexpr int least_blocks = 2;

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

double first_pass_seconds(const PreviewSeconds& preview, double texels) {
  constexpr double more_points = 3, more_photons = 5, power_of_texels = 0.55;
  return more_points * preview.points + more_photons * preview.photons +
         std::pow(texels, power_of_texels) * preview.rest;
}

bool PassSchedule::is_large() const { return texels > most_without_preview; }

bool PassSchedule::has_time_for_fine_walls(double direct, bool has_samples) {
  const double samples = took.walls * (has_samples ? more_samples : 1);
  took.fine_walls = more_ways * direct + samples;
  // Fine walls may take at most half of the remaining time.
  if (is_over(2 * took.fine_walls)) return false;
  took.walls = samples;
  return true;
}

void PassSchedule::end_block() {
  const double end = now();
  took.block = end - block_began_;
  block_began_ = end;
}

bool PassSchedule::goes_on(int done, bool has_preview) const {
  if (done >= least_blocks) return !is_late();
  // With fewer blocks, only the first picture can be returned. The steps before a first block
  // take about as long as the least number of blocks.
  if (done == 0) return !has_preview || !is_late();
  return !has_preview || !limit_.is_over(took.block + closing_seconds());
}

bool PassSchedule::is_too_short(int done) { return done < least_blocks; }

bool PassSchedule::wants_finer_texels(const EndedPass& pass) const {
  return !pass.is_cut() && !is_late() && is_out_of_reach(error_, pass.bias_percent());
}

int PassSchedule::blocks_after(const EndedPass& pass) const {
  return next_blocks(pass.blocks, pass.error.noise, target_of(pass));
}

NextStep PassSchedule::after(const EndedPass& pass) const {
  if (pass.error.noise <= target_of(pass)) return NextStep::end;
  if (pass.is_cut() || is_late()) return NextStep::end_unfinished;
  return blocks_after(pass) > pass.planned ? NextStep::more_blocks : NextStep::end;
}

double PassSchedule::closing_seconds() const {
  return took.texel * static_cast<double>(std::max<std::size_t>(1, texels)) + took.walls;
}

double PassSchedule::target_of(const EndedPass& pass) const {
  return std::pow(noise_to_reach(error_, pass.bias_percent()) / 100, 2);
}

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>

#include "bake/driver/time_limit.h"
#include "bake/texels/isovalue_error.h"
#include "base/progress.h"

namespace leaflight {

// True if no number of blocks reaches the target error. `bias`: the error in percent of any number.
bool is_out_of_reach(double error, double bias);

// Returns the noise, in percent, at which a bake ends: the part of the target error that the
// bias leaves, within bounds.
double noise_to_reach(double error, double bias);

// Returns the blocks of the first pass. At least two are needed to estimate the error.
int first_blocks(std::size_t texels);

// Returns the number of blocks after the next pass. It aims at the variance `target`, given the
// variance `noise` of `now` blocks. It is at most twice `now`, or eight.
int next_blocks(int now, double noise, double target);

// The time of a first picture in seconds: points of its error estimate, photons, and the rest.
struct PreviewSeconds {
  double points = 0, photons = 0, rest = 0;
  double all() const { return points + photons + rest; }
};

// Predicts the time of a first pass without walls. `texels`: ratio of its texels of indirect light
// to those of the first picture. Measured factors: docs/decisions/error-and-time.md.
double first_pass_seconds(const PreviewSeconds& preview, double texels);

// The last measured times of the steps of a bake, in seconds.
struct StepSeconds {
  PreviewSeconds preview;
  double walls = 0, block = 0;
  double texel = 0;       // of the result, for each of its texels
  double fine_walls = 0;  // predicted, with their direct light
};

// A pass that has ended.
struct EndedPass {
  int blocks = 0, planned = 0;  // of the whole bake
  IsovalueError error;

  bool is_cut() const { return blocks < planned; }
  double bias_percent() const { return 100 * std::sqrt(error.bias); }
};

enum class NextStep { more_blocks, end, end_unfinished };

// Decides what a bake does next. The decisions follow from numbers alone: measured times, errors
// and numbers of texels.
class PassSchedule {
 public:
  // `error`: the target in percent.
  PassSchedule(const TimeLimit& limit, double error, const Progress& progress)
      : limit_(limit), error_(error), progress_(progress) {}

  std::size_t texels = 0;  // of the bake
  StepSeconds took;

  double now() const { return limit_.seconds(); }
  bool is_limited() const { return limit_.is_given(); }
  // True if a step of this duration would end too late.
  bool is_over(double seconds) const { return progress_.stopped() || limit_.is_over(seconds); }

  // True if the bake is so large that a first picture should be shown.
  bool is_large() const;
  // Predicts the time of fine walls. Returns true if it may be taken. `direct`: seconds of the
  // direct light of coarse walls. `has_samples`: true if walls take samples of their own.
  bool has_time_for_fine_walls(double direct, bool has_samples);
  // True if the time suffices for a first pass; see first_pass_seconds().
  bool has_time_for(double ratio) const {
    return !is_over(first_pass_seconds(took.preview, ratio) + took.walls);
  }
  // True if the blocks of a first picture cannot be repeated in time.
  bool ends_with_preview() const { return is_over(took.preview.all() + closing_seconds()); }

  void begin_block() { block_began_ = now(); }
  void end_block();
  // True if another block would end too late. It is assumed to take as long as the last one.
  bool is_late() const { return is_over(took.block + closing_seconds()); }
  // True if a pass may go on after `done` blocks. `has_preview`: true if another picture can be
  // returned instead.
  bool goes_on(int done, bool has_preview) const;
  // True if a pass of `done` blocks is of no use where there is another picture.
  static bool is_too_short(int done);

  // True if finer texels would lower an error that more blocks cannot lower.
  bool wants_finer_texels(const EndedPass& pass) const;
  // Returns the number of blocks after the next pass.
  int blocks_after(const EndedPass& pass) const;
  NextStep after(const EndedPass& pass) const;

 private:
  // Estimates the time of the steps after the blocks.
  double closing_seconds() const;
  // Returns the variance at which the bake ends.
  double target_of(const EndedPass& pass) const;

  TimeLimit limit_;
  double error_;
  const Progress& progress_;
  double block_began_ = 0;
};

}  // namespace leaflight

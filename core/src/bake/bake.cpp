// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/bake.h"

#include <tbb/task_arena.h>

#include <chrono>

#include "leaflight/bake/fixed_samples.h"
#include "leaflight/bake/rounds.h"
#include "leaflight/math/error.h"
#include "leaflight/math/platform.h"

namespace leaflight {
namespace {

// What a bake takes that was to be in rounds and cannot be.
constexpr int default_samples = 32;

}  // namespace

template <int D>
Baked<D> bake(const Scene<D>& scene, const BakeSettings<D>& settings, Progress& progress,
              const OnRound<D>& on_round, const KeptLight<D>* kept,
              const Checkpoints* checkpoints) {
  return bake(scene, settings, make_plan(scene, settings), progress, on_round, kept, checkpoints);
}

template <int D>
Baked<D> bake(const Scene<D>& scene, const BakeSettings<D>& settings, const Plan& plan,
              Progress& progress, const OnRound<D>& on_round, const KeptLight<D>* kept,
              const Checkpoints* checkpoints) {
  validate(scene);
  validate(settings);
  const auto start = std::chrono::steady_clock::now();
  const auto finish = [&](Baked<D>& baked) {
    baked.statistics.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    baked.statistics.peak_memory_bytes = peak_memory();
    baked.statistics.skipped = plan.skipped;
  };
  const OnRound<D> timed = [&](Baked<D>&& baked) {
    if (!on_round) return;
    finish(baked);
    on_round(std::move(baked));
  };
  tbb::task_arena arena(settings.threads > 0 ? settings.threads : tbb::task_arena::automatic);
  Baked<D> baked = arena.execute([&] {
    if (fits_rounds(scene, settings, plan)) {
      return bake_in_rounds(scene, settings, plan, progress, timed, kept, checkpoints);
    }
    if (kept) throw Error("Only a bake in rounds can be continued; bake the volume anew.");
    BakeSettings<D> fixed = settings;
    if (fixed.samples == 0) fixed.samples = default_samples;
    return bake_with_fixed_samples(scene, fixed, plan, progress);
  });
  finish(baked);
  return baked;
}

template Baked<2> bake<2>(const Scene<2>&, const BakeSettings<2>&, Progress&, const OnRound<2>&,
                          const KeptLight<2>*, const Checkpoints*);
template Baked<2> bake<2>(const Scene<2>&, const BakeSettings<2>&, const Plan&, Progress&,
                          const OnRound<2>&, const KeptLight<2>*, const Checkpoints*);
template Baked<3> bake<3>(const Scene<3>&, const BakeSettings<3>&, Progress&, const OnRound<3>&,
                          const KeptLight<3>*, const Checkpoints*);
template Baked<3> bake<3>(const Scene<3>&, const BakeSettings<3>&, const Plan&, Progress&,
                          const OnRound<3>&, const KeptLight<3>*, const Checkpoints*);

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/bake.h"

#include <tbb/task_arena.h>

#include <chrono>

#include "bake/driver/passes.h"
#include "base/platform.h"

namespace leaflight {
template <int D>
Baked<D> bake(const Scene<D>& scene, const BakeSettings<D>& settings, Progress& progress,
              const BakeHooks<D>& hooks) {
  validate(scene);
  validate(settings);
  const Plan plan = make_plan(scene, settings);
  const auto start = std::chrono::steady_clock::now();
  const auto finish = [&](Baked<D>& baked) {
    baked.statistics.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    baked.statistics.peak_memory_bytes = peak_memory();
    std::vector<SkippedPass>& skipped = baked.statistics.skipped;
    skipped.insert(skipped.begin(), plan.skipped.begin(), plan.skipped.end());
  };
  BakeHooks<D> timed = hooks;
  if (hooks.on_pass) {
    timed.on_pass = [&](Baked<D>&& baked) {
      finish(baked);
      hooks.on_pass(std::move(baked));
    };
  }
  tbb::task_arena arena(settings.threads > 0 ? settings.threads : tbb::task_arena::automatic);
  Baked<D> baked =
      arena.execute([&] { return bake_in_passes(scene, settings, plan, progress, timed); });
  finish(baked);
  return baked;
}

template Baked<2> bake(const Scene<2>&, const BakeSettings<2>&, Progress&, const BakeHooks<2>&);
template Baked<3> bake(const Scene<3>&, const BakeSettings<3>&, Progress&, const BakeHooks<3>&);

}  // namespace leaflight

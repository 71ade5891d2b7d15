// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/rounds.h"

#include <chrono>
#include <cmath>

#include "leaflight/bake/rounds_texels.h"
#include "leaflight/math/error.h"
#include "leaflight/transport/placement.h"

namespace leaflight {
namespace {

// Bakes of fewer texels do without a first picture.
constexpr std::size_t most_without_preview = 200'000;
// Blocks of a first picture, of the first round, since their differences tell the error, and of all
// rounds at most.
constexpr int preview_blocks = 2, first_blocks = 4, most_blocks = 32;
// A round that is out of time ends after so many.
constexpr int least_blocks = 2;
// What noise may be of the error that is asked for: what the texels' width leaves of it, within
// these shares; and of what texels miss, where that alone is more, as sweeps do not mend it.
constexpr double least_noise = 0.25, most_noise = 0.8, out_of_reach_noise = 0.5;

// The blocks after the next round: as many as leave the noise `target`, a variance, by what was
// found so far; at most twice as many as now.
template <int D>
int next_blocks(const SweptBake<D>& bake, double target) {
  const int now = bake.blocks();
  if (now == 0) return 0;
  const double wanted = bake.errors().all().noise * now / target;
  const int most = std::max(now, std::min(2 * now, most_blocks));
  // A round that adds little costs as much to look at as one that adds more.
  const double grown = wanted > now ? std::max(std::ceil(wanted), std::ceil(1.25 * now)) : now;
  return static_cast<int>(std::clamp<double>(grown, now, most));
}

}  // namespace

double noise_to_reach(double error, double texture) {
  const double least = texture < error ? least_noise * error : out_of_reach_noise * texture;
  const double wanted = std::sqrt(std::max(0.0, error * error - texture * texture));
  return std::clamp(wanted, least, std::max(least, most_noise * error));
}

template <int D>
bool fits_rounds(const Scene<D>& scene, const BakeSettings<D>& settings, const Plan& plan) {
  return settings.samples == 0 && settings.estimator == EstimatorName::gather && !settings.thesis &&
         settings.only_at.empty() && scene.volumes.size() == 1 &&
         scene.volumes[0].scattering == Scattering::diffuse && !plan.specular;
}

template <int D>
Baked<D> bake_in_rounds(const Scene<D>& scene, const BakeSettings<D>& settings, const Plan& plan,
                        Progress& progress, const BakeHooks<D>& hooks) {
  const KeptLight<D>* kept = hooks.kept;
  const Checkpoints* checkpoints = hooks.checkpoints;
  const auto& on_round = hooks.on_round;
  const auto start = std::chrono::steady_clock::now();
  const SceneTracer<D> tracer(scene);
  check_placement(tracer);
  const LightSampler<D> lights(tracer);
  const SplitLight<D> split = split_light(tracer);
  const EmptySpace<D> empty(scene.volumes[0].field, scene.volumes[0].isovalues(scene.window).min);
  const SweptVolume<D> volume{tracer, 0, empty};
  progress.check();
  SweptTexels<D> texels = rounds_texels(volume, settings);
  progress.check();
  const std::size_t count = texels.shown.lattice.active.size();
  if (count == 0) {
    throw Error(
        "No isosurface of the isovalue window passes through the volume; widen the window.");
  }
  if (kept && kept->resolution() != texels.shown.lattice.resolution) kept = nullptr;
  if (kept && plan.indirect && !kept->fits(texels.shown.lattice, texels.soft.lattice, plan.back)) {
    throw Error(
        "The bake to continue is of another volume, window or other sides; bake the volume anew.");
  }
  // Until sweeps know what they cost.
  const double sides = plan.back ? 2 : 1;
  double work = sides * static_cast<double>(texels.shown.lattice.texels() * split.points.size());
  progress.expect(work + first_blocks * static_cast<double>(texels.shown.lattice.texels()) *
                             IndirectLight<D>::directions_per_block /
                             std::pow(texels.spacing, D - 1));
  progress.begin("Direct light");
  const auto direct = std::make_shared<const DirectLight<D>>(
      tracer, 0, split.points,
      map_resolution(volume.volume().field, volume.window(), texels.shown.lattice.resolution,
                     split.points.size()),
      plan.back, progress);
  work = sides * static_cast<double>(direct->lattice().texels() * split.points.size());
  std::atomic<std::uint64_t> rays{0};
  int rounds = kept ? kept->rounds() : 0;
  const auto seconds_since = [](std::chrono::steady_clock::time_point then) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - then).count();
  };
  double seconds_a_texel = 0;  // that whole() takes
  const auto whole = [&](SweptBake<D>& bake) {
    const auto begin = std::chrono::steady_clock::now();
    Baked<D> baked;
    baked.grids.push_back(bake.grid());
    seconds_a_texel = seconds_since(begin) / static_cast<double>(baked.grids[0].texels());
    baked.statistics.rays = rays;
    baked.statistics.rounds = rounds;
    baked.statistics.blocks = bake.blocks();
    const LeafError error = bake.errors().all();
    baked.statistics.noise_percent = 100 * std::sqrt(error.noise);
    baked.statistics.error_percent = error.percent();
    baked.statistics.worst = bake.errors().worst();
    return baked;
  };
  const auto over = [&](double to_come) {
    return progress.stopped() ||
           (settings.seconds > 0 && seconds_since(start) + to_come > settings.seconds);
  };
  // A bake's last round, which has the surroundings, too.
  const auto last = [&](SweptBake<D>& bake, Baked<D> baked, bool stopped) {
    if (plan.surroundings) baked.surroundings = bake.surroundings();
    baked.statistics.rays = rays;
    baked.statistics.stopped = stopped;
    return baked;
  };
  const bool resumes = checkpoints && checkpoints->from;
  std::unique_ptr<SweptBake<D>> preview;
  if (!kept && count > most_without_preview) {
    ++rounds;
    if ((on_round || settings.seconds > 0) && !resumes) {
      preview = std::make_unique<SweptBake<D>>(
          volume, lights, split, direct, settings, plan, progress, rays,
          preview_texels(volume, texels.shown.lattice.resolution));
      preview->add(preview_blocks);
      Baked<D> first = whole(*preview);
      if (on_round) on_round(std::move(first));
      if (over(0)) return last(*preview, whole(*preview), true);
    }
  }
  SweptBake<D> bake(volume, lights, split, direct, settings, plan, progress, rays,
                    std::move(texels), kept, hooks.workers);
  const int before = bake.blocks();
  int blocks = plan.indirect ? before + first_blocks : 0;
  const auto keep = [&](Keeper keeper) {
    // Numbers are kept as this build has them in memory.
    int layout = sizeof(Real) * 256 + D;
    const int own_layout = layout;
    keeper(layout);
    if (layout != own_layout) throw Error("The checkpoint is of another Leaflight; bake anew.");
    std::uint64_t traced = rays;
    keeper(traced);
    keeper(rounds);
    keeper(blocks);
    bake.keep(keeper);
    rays = traced;
  };
  if (resumes) keep(Keeper(*checkpoints->from));
  auto saved = start, block_began = start;
  const std::function<bool()> go_on = [&] {
    const double block_seconds = seconds_since(block_began);
    block_began = std::chrono::steady_clock::now();
    // The next block takes about as long as the one before.
    if (checkpoints && checkpoints->save &&
        seconds_since(saved) + block_seconds >= checkpoints->seconds) {
      checkpoints->save([&](std::ostream& stream) { keep(Keeper(stream)); });
      saved = std::chrono::steady_clock::now();
    }
    const int done = bake.blocks() - before;
    const bool can_end = done >= least_blocks || (done == 0 && preview);
    return !can_end || !over(seconds_a_texel * static_cast<double>(count));
  };
  for (;;) {
    // The bounces before count, too, and the radiance of the texels afterwards.
    progress.expect(work + bake.cost() * (blocks - before + 2));
    bake.add(blocks - bake.blocks(), go_on);
    const bool cut = bake.blocks() < blocks;
    if (cut && bake.blocks() == before) return last(*preview, whole(*preview), true);
    preview.reset();
    ++rounds;
    Baked<D> baked = whole(bake);
    const LeafError error = bake.errors().all();
    const double noise = noise_to_reach(settings.error, 100 * std::sqrt(error.texture));
    const double target = std::pow(noise / 100, 2);
    if (error.noise <= target) return last(bake, std::move(baked), false);
    if (cut || over(0)) return last(bake, std::move(baked), true);
    const int next = next_blocks(bake, target);
    if (next <= blocks) return last(bake, std::move(baked), false);
    if (on_round) on_round(std::move(baked));
    // What was shown is what is left.
    if (over(0)) return last(bake, whole(bake), true);
    blocks = next;
  }
}

template bool fits_rounds<2>(const Scene<2>&, const BakeSettings<2>&, const Plan&);
template bool fits_rounds<3>(const Scene<3>&, const BakeSettings<3>&, const Plan&);
template Baked<2> bake_in_rounds(const Scene<2>&, const BakeSettings<2>&, const Plan&, Progress&,
                                 const BakeHooks<2>&);
template Baked<3> bake_in_rounds(const Scene<3>&, const BakeSettings<3>&, const Plan&, Progress&,
                                 const BakeHooks<3>&);

}  // namespace leaflight

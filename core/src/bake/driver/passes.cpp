// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/passes.h"

#include <chrono>
#include <cmath>

#include "bake/driver/measured_error.h"
#include "bake/driver/pass_texels.h"
#include "bake/driver/ray_bake.h"
#include "math/error.h"

namespace leaflight {
namespace {

// Bakes of fewer texels do without a first picture.
constexpr std::size_t most_without_preview = 200'000;
// Blocks of a first picture, and of all passes at most.
constexpr int preview_blocks = 2, most_blocks = 32;
// How much wider the texels of its maps are, and the voxels between their lines.
constexpr int preview_spacing = 2;
// Estimates at each point where its error is measured; all of them would delay it.
constexpr int preview_estimates = 2;
// Bakes of fewer texels begin with four blocks, which take little time there.
constexpr std::size_t few_texels = 1'500'000;
// A pass that is out of time ends after so many.
constexpr int least_blocks = 2;
// The noise to reach, as a share of the target error: what the texture error leaves of it. Where
// that is less than the least, passes would take several times as long for an error that hardly
// falls: a share of the texture error is enough.
constexpr double least_noise = 0.4, most_noise = 0.8, out_of_reach_noise = 0.5;

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point then) {
  return std::chrono::duration<double>(Clock::now() - then).count();
}

// Blocks of the first pass. The difference of two shows the error.
int first_blocks(std::size_t texels) { return texels < few_texels ? 4 : 2; }

// The blocks after the next pass: as many as leave the noise `target`, a variance, by what was
// found so far; at most twice as many as now, or eight.
int next_blocks(int now, double noise, double target) {
  if (now == 0) return 0;
  const double wanted = noise * now / target;
  const int most = std::max(now, std::min(std::max(2 * now, 8), most_blocks));
  // A pass that adds little costs as much to look at as one that adds more.
  const double grown = wanted > now ? std::max(std::ceil(wanted), std::ceil(1.25 * now)) : now;
  return static_cast<int>(std::clamp<double>(grown, now, most));
}

template <int D>
class Passes {
 public:
  Passes(const Scene<D>& scene, const BakeSettings<D>& settings, const Plan& plan,
         Progress& progress, const BakeHooks<D>& hooks)
      : hooks_(hooks),
        scene_(scene, settings, plan, progress),
        progress_(progress),
        errors_(scene.isovalue_range) {}

  Baked<D> run() {
    progress_.check();
    if (hooks_.workers && !scene_.plan.lines) {
      throw Error(
          "Workers share the lines through one volume without mirrors or glass; bake without "
          "them.");
    }
    std::vector<BakeTexels<D>> texels;
    for (const LineVolume<D>& volume : scene_.volumes) {
      texels.push_back(scene_.plan.lines ? pass_texels(volume, scene_.settings)
                                         : ray_texels(volume, scene_.settings));
    }
    std::vector<Index<D>> shown;
    for (const BakeTexels<D>& one : texels) {
      shown.push_back(one.shown.lattice.resolution);
      count_ += one.shown.lattice.active.size();
    }
    progress_.check();
    if (count_ == 0 && !scene_.plan.walls) throw nothing_to_bake(scene_.tracer.scene());
    const Previous* previous = previous_light(texels);
    expect(texels);
    measured_.emplace(scene_, texels);
    passes_ = previous ? previous->front().passes() : 0;
    if (!previous && count_ > most_without_preview) {
      ++passes_;
      if ((hooks_.on_pass || scene_.settings.seconds > 0) && !resumes()) {
        measured_->trace(texels, preview_estimates);
        preview(shown);
      }
    }
    work_ += scene_.learn_direct(shown, 1);
    if (preview_ && over(0)) return last(*preview_, whole(*preview_), true);
    measured_->trace(texels, MeasuredError<D>::most_estimates);
    bake_ = integrator(std::move(texels), previous, hooks_.workers);
    return subdivide();
  }

 private:
  using Previous = std::vector<PreviousLight<D>>;

  bool resumes() const { return hooks_.checkpoints && hooks_.checkpoints->restore; }

  std::unique_ptr<Integrator<D>> integrator(std::vector<BakeTexels<D>> texels,
                                            const Previous* previous, const BlockWorkers* workers) {
    if (!scene_.plan.lines) {
      return std::make_unique<RayBake<D>>(scene_, std::move(texels), previous);
    }
    const PreviousLight<D>* light = previous ? &previous->front() : nullptr;
    return std::make_unique<LineBake<D>>(scene_, 0, std::move(texels[0]), light, workers);
  }

  // A first picture, from coarse texels and maps.
  void preview(const std::vector<Index<D>>& shown) {
    std::vector<Index<D>> coarse;
    std::vector<BakeTexels<D>> texels;
    for (std::size_t v = 0; v < shown.size(); ++v) {
      coarse.push_back(coarser_resolution<D>(shown[v], preview_spacing));
      texels.push_back(preview_texels(scene_.volumes[v], shown[v]));
    }
    work_ += scene_.learn_direct(coarse, preview_spacing);
    preview_ = integrator(std::move(texels), nullptr, nullptr);
    preview_->add(preview_blocks);
    if (hooks_.on_pass) hooks_.on_pass(whole(*preview_));
  }

  // What the bake goes on with; null where it has texels of another width.
  const Previous* previous_light(const std::vector<BakeTexels<D>>& texels) const {
    const Previous* previous = hooks_.previous;
    if (!previous) return nullptr;
    bool fits = previous->size() == texels.size();
    for (std::size_t v = 0; v < texels.size() && fits; ++v) {
      if (!scene_.stores_light_of(v)) continue;
      const TexelLattice<D>& shown = texels[v].shown.lattice;
      if ((*previous)[v].resolution() != shown.resolution) return nullptr;
      fits = !scene_.plan.indirect ||
             (*previous)[v].fits(shown, texels[v].indirect.lattice, scene_.plan.back);
    }
    if (fits) return previous;
    throw Error(
        "The bake to continue is of another volume, isovalue range or other sides; bake the volume "
        "anew.");
  }

  // Work of the maps and of the first pass, until the time of a block is known.
  void expect(const std::vector<BakeTexels<D>>& texels) {
    const auto points = static_cast<double>(scene_.split.points.size());
    double work = 0;
    for (const BakeTexels<D>& one : texels) {
      const auto all = static_cast<double>(one.shown.lattice.texels());
      work += scene_.sides() * all * points + first_blocks(count_) * all *
                                                  IndirectLight<D>::directions_per_block /
                                                  std::pow(one.spacing, D - 1);
    }
    progress_.expect(work);
  }

  // Pass by pass.
  Baked<D> subdivide() {
    const int before = before_ = bake_->blocks();
    blocks_ = scene_.plan.indirect ? before + first_blocks(count_) : 0;
    if (resumes()) {
      hooks_.checkpoints->restore([this](std::istream& stream) { serialize(Archive(stream)); });
    }
    const std::function<bool()> proceed = [this] { return go_on(); };
    for (;;) {
      // The steps before count, too, and the radiance of the texels afterwards.
      progress_.expect(work_ + bake_->cost() * (blocks_ - before + 2));
      bake_->add(blocks_ - bake_->blocks(), proceed);
      const bool cut = bake_->blocks() < blocks_;
      if (cut && bake_->blocks() == before) return last(*preview_, whole(*preview_), true);
      preview_.reset();
      ++passes_;
      Baked<D> baked = whole(*bake_);
      const IsovalueError error = errors_.all();
      const double noise = noise_to_reach(scene_.settings.error, 100 * std::sqrt(error.texture));
      const double target = std::pow(noise / 100, 2);
      if (error.noise <= target) return last(*bake_, std::move(baked), false);
      if (cut || over(0)) return last(*bake_, std::move(baked), true);
      const int next = next_blocks(bake_->blocks(), error.noise, target);
      if (next <= blocks_) return last(*bake_, std::move(baked), false);
      if (hooks_.on_pass) {
        // Where isosurfaces store no light, the walls are all that there is to see.
        if (count_ == 0) baked.walls = bake_->walls();
        hooks_.on_pass(std::move(baked));
      }
      // What was shown is what is left.
      if (over(0)) return last(*bake_, whole(*bake_), true);
      blocks_ = next;
    }
  }

  // After each block: leaves a checkpoint where one is due. Whether time is left for another.
  bool go_on() {
    const double block_seconds = seconds_since(block_began_);
    block_began_ = Clock::now();
    const Checkpoints* checkpoints = hooks_.checkpoints;
    // The next block takes about as long as the one before.
    if (checkpoints && checkpoints->save &&
        seconds_since(saved_) + block_seconds >= checkpoints->seconds) {
      checkpoints->save([this](std::ostream& stream) { serialize(Archive(stream)); });
      saved_ = Clock::now();
    }
    const int done = bake_->blocks() - before_;
    const bool can_end = done >= least_blocks || (done == 0 && preview_);
    return !can_end || !over(seconds_a_texel_ * static_cast<double>(count_));
  }

  void serialize(Archive archive) {
    // Numbers are stored as this build has them in memory.
    int layout = sizeof(Real) * 256 + D;
    const int own_layout = layout;
    archive(layout);
    if (layout != own_layout) throw Error("The checkpoint is of another Leaflight; bake anew.");
    const std::uint64_t before = rays();
    std::uint64_t traced = before;
    archive(traced);
    archive(passes_);
    archive(blocks_);
    bake_->serialize(archive);
    progress_.count_rays(traced - before);
  }

  std::uint64_t rays() const { return progress_.rays() - first_rays_; }

  bool over(double to_come) const {
    const double seconds = scene_.settings.seconds;
    return progress_.stopped() || (seconds > 0 && seconds_since(start_) + to_come > seconds);
  }

  Baked<D> whole(Integrator<D>& bake) {
    const auto begin = Clock::now();
    Baked<D> baked;
    baked.grids = bake.grids();
    std::size_t texels = 0;
    for (const RadianceGrid<D>& grid : baked.grids) texels += grid.texels();
    seconds_a_texel_ = seconds_since(begin) / static_cast<double>(std::max<std::size_t>(1, texels));
    baked.statistics.rays = rays();
    baked.statistics.passes = passes_;
    baked.statistics.blocks = bake.blocks();
    errors_ = bake.errors();
    measured_->add_to(errors_, baked.grids);
    const IsovalueError error = errors_.all();
    baked.statistics.noise_percent = 100 * std::sqrt(error.noise);
    baked.statistics.error_percent = error.percent();
    baked.statistics.worst = errors_.worst();
    return baked;
  }

  // A bake's last pass, which has the walls, too.
  Baked<D> last(Integrator<D>& bake, Baked<D> baked, bool stopped) {
    if (scene_.plan.walls) baked.walls = bake.walls();
    baked.statistics.rays = rays();
    baked.statistics.stopped = stopped;
    return baked;
  }

  const Clock::time_point start_ = Clock::now();
  const BakeHooks<D>& hooks_;
  LitScene<D> scene_;
  Progress& progress_;
  const std::uint64_t first_rays_ = progress_.rays();  // of others, before
  std::size_t count_ = 0;                              // of all texels
  double work_ = 0;                                    // of direct light
  int passes_ = 0;
  int before_ = 0, blocks_ = 0;  // blocks of the previous bake, and those after the pass
  double seconds_a_texel_ = 0;   // that whole() takes
  Clock::time_point saved_ = start_, block_began_ = start_;
  std::unique_ptr<Integrator<D>> preview_, bake_;
  std::optional<MeasuredError<D>> measured_;
  IsovalueErrors errors_;  // of the last whole bake
};

}  // namespace

double noise_to_reach(double error, double texture) {
  const double wanted = std::sqrt(std::max(0.0, error * error - texture * texture));
  if (wanted < least_noise * error) return out_of_reach_noise * texture;
  return std::min(wanted, most_noise * error);
}

template <int D>
Baked<D> bake_in_passes(const Scene<D>& scene, const BakeSettings<D>& settings, const Plan& plan,
                        Progress& progress, const BakeHooks<D>& hooks) {
  return Passes<D>(scene, settings, plan, progress, hooks).run();
}

template Baked<2> bake_in_passes(const Scene<2>&, const BakeSettings<2>&, const Plan&, Progress&,
                                 const BakeHooks<2>&);
template Baked<3> bake_in_passes(const Scene<3>&, const BakeSettings<3>&, const Plan&, Progress&,
                                 const BakeHooks<3>&);

}  // namespace leaflight

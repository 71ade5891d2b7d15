// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/passes.h"

#include "bake/driver/line_bake.h"
#include "bake/driver/measured_error.h"
#include "bake/driver/pass_schedule.h"
#include "bake/driver/previous_texels.h"
#include "bake/driver/ray_bake.h"
#include "base/error.h"

namespace leaflight {
namespace {

// Parameters of a first picture: its blocks, the spacing of its visibility sweeps, and the
// estimates per point of its error. All estimates would delay it.
constexpr int preview_blocks = 2, preview_spacing = 2, preview_estimates = 2;

template <int D>
std::size_t texels_of_indirect_light(const std::vector<BakeTexels<D>>& texels) {
  std::size_t count = 0;
  for (const BakeTexels<D>& one : texels) count += one.indirect.lattice.active.size();
  return count;
}

template <int D>
class Passes {
 public:
  Passes(const Scene<D>& scene, const BakeSettings<D>& settings, const Plan& plan,
         Progress& progress, const BakeHooks<D>& hooks)
      : schedule_(TimeLimit(settings.seconds, hooks.clock), settings.error, progress),
        hooks_(hooks),
        scene_(scene, settings, plan, progress),
        progress_(progress),
        errors_(scene.isovalue_range) {
    scene_.workers = hooks.workers;
  }

  Baked<D> run() {
    progress_.check();
    if (hooks_.workers && !scene_.plan.lines) {
      throw Error(
          "Workers help bakes of one volume without mirrors or glass; bake without "
          "them.");
    }
    set_texels(Texels::usual);
    progress_.check();
    if (schedule_.texels == 0 && !scene_.plan.walls) throw nothing_to_bake(scene_.tracer.scene());
    if (hooks_.previous) {
      const std::optional<Texels> kind = previous_texels(scene_, *hooks_.previous);
      if (kind) previous_ = hooks_.previous;
      previous_texels_ = kind.value_or(Texels::usual);
      if (previous_texels_ != Texels::usual) set_texels(previous_texels_);
    }
    expect();
    measured_.emplace(scene_, texels_);
    passes_ = previous_ ? previous_->front().passes() : 0;
    if (resumes()) {
      hooks_.checkpoints->restore([this](std::istream& stream) { serialize(Archive(stream)); });
    } else {
      begin(first_picture());
    }
    return run_passes();
  }

 private:
  using Previous = std::vector<PreviousLight<D>>;

  bool resumes() const { return hooks_.checkpoints && hooks_.checkpoints->restore; }

  void set_texels(Texels kind) {
    texels_ = texels_of(scene_, kind);
    count_texels();
  }

  void count_texels() {
    shown_.clear();
    schedule_.texels = 0;
    for (const BakeTexels<D>& one : texels_) {
      shown_.push_back(one.shown.lattice.resolution);
      schedule_.texels += one.shown.lattice.active.size();
    }
    if (!texels_.empty()) indirect_resolution_ = texels_[0].indirect.lattice.resolution;
  }

  std::unique_ptr<Integrator<D>> integrator(std::vector<BakeTexels<D>> texels,
                                            const Previous* previous, const Workers* workers) {
    if (!scene_.plan.lines) {
      return std::make_unique<RayBake<D>>(scene_, std::move(texels), previous);
    }
    const PreviousLight<D>* light = previous ? &previous->front() : nullptr;
    return std::make_unique<LineBake<D>>(scene_, std::move(texels[0]), light, workers);
  }

  // Shows a first picture if the bake is large. Returns the finest texels that the time allows.
  Texels first_picture() {
    const bool is_large = schedule_.is_large(), is_limited = schedule_.is_limited();
    if (previous_) return previous_texels_;
    if (schedule_.texels == 0 || !(is_large || is_limited)) return Texels::usual;
    if (is_large) ++passes_;
    if (!hooks_.on_pass && !is_limited) return Texels::usual;
    PreviewSeconds& took = schedule_.took.preview;
    const double began = schedule_.now();
    measured_->trace(texels_, preview_estimates);
    took.points = schedule_.now() - began;
    make_preview();
    preview_->add(preview_blocks);
    Baked<D> baked = bake_so_far(*preview_);
    took.rest = schedule_.now() - began - took.all();
    if (hooks_.on_pass && is_large) hooks_.on_pass(std::move(baked));
    if (is_limited && scene_.plan.walls) choose_wall_detail();
    return fits(texels_) ? Texels::usual : wider_in_time();
  }

  // Measures the time of coarse walls, to decide if there is time for fine ones.
  void choose_wall_detail() {
    scene_.wall_detail = least_wall_detail;
    scene_.subdivided();
    const double began = schedule_.now();
    scene_.compute_wall_direct_light();
    const double direct = schedule_.now() - began;
    preview_walls_ = walls(*preview_);
    // A bake by rays samples walls in the blocks of the volume.
    if (!schedule_.has_time_for_fine_walls(direct, scene_.plan.lines)) return;
    preview_walls_.reset();
    scene_.wall_detail = WallDetail();
    scene_.compute_wall_direct_light();
  }

  Texels wider_in_time() { return fits(wider()) ? Texels::wide : Texels::preview; }

  std::vector<BakeTexels<D>>& wider() {
    if (wider_.empty()) wider_ = texels_of(scene_, Texels::wide);
    return wider_;
  }

  // True if the time suffices for a first pass with these texels.
  bool fits(const std::vector<BakeTexels<D>>& texels) const {
    const double ratio = static_cast<double>(texels_of_indirect_light(texels)) /
                         static_cast<double>(preview_texels_);
    return schedule_.has_time_for(ratio);
  }

  void make_preview() {
    std::vector<Index<D>> coarse;
    std::vector<BakeTexels<D>> texels;
    for (std::size_t v = 0; v < shown_.size(); ++v) {
      coarse.push_back(coarser_resolution<D>(shown_[v], preview_spacing));
      texels.push_back(preview_texels(scene_.volumes[v], shown_[v]));
    }
    preview_texels_ = std::max<std::size_t>(1, texels_of_indirect_light(texels));
    scene_.compute_visibility_maps(coarse, preview_spacing);
    const double began = schedule_.now();
    preview_ = integrator(std::move(texels), nullptr, nullptr);
    schedule_.took.preview.photons = schedule_.now() - began;
  }

  // Makes the integrator of these texels.
  void begin(Texels chosen) {
    chosen_ = chosen;
    bake_.reset();
    const bool is_preview = chosen == Texels::preview, is_usual = chosen == Texels::usual;
    if (is_preview) {
      measured_->trace(texels_, preview_estimates);
    } else if (hooks_.workers && !schedule_.is_limited()) {
      measured_->share(*hooks_.workers);
      scene_.share_shadow_rays();
    } else {
      measured_->trace(texels_, MeasuredError<D>::most_estimates);
    }
    if (is_preview) {
      if (!preview_) make_preview();
      schedule_.texels = preview_texels_;
      bake_ = std::move(preview_);
    } else {
      if (chosen == Texels::wide) {
        texels_ = std::move(wider());
        count_texels();
      } else if (chosen == Texels::fine && previous_texels_ != Texels::fine) {
        texels_ = fine_.empty() ? texels_of(scene_, chosen) : std::move(fine_);
        count_texels();
      }
      scene_.compute_visibility_maps(shown_, 1);
      bake_ = integrator(std::move(texels_), previous_, is_usual ? hooks_.workers : nullptr);
    }
    texels_.clear();
    wider_.clear();
    fine_.clear();
    if (schedule_.is_limited() && scene_.plan.walls) scene_.compute_wall_direct_light();
    before_ = previous_ ? bake_->blocks() : 0;
    blocks_ = scene_.plan.indirect ? before_ + first_blocks(schedule_.texels) : 0;
  }

  // Sets the expected work of the steps before the walls, before the integrator exists.
  void expect() {
    const auto points = static_cast<double>(scene_.split.points.size());
    double work = 0;
    for (const BakeTexels<D>& one : texels_) {
      const auto all = static_cast<double>(one.shown.lattice.texels());
      work += scene_.sides() * all * points * MapSweeps<D>::work_of_texel +
              first_blocks(schedule_.texels) *
                  IndirectLight<D>::cost(one.indirect.lattice, one.spacing);
    }
    progress_.expect(progress_.work() + work + scene_.cost_of_walls());
  }

  // Sets the expected work: past work, the blocks, the steps before them and the walls.
  void expect_pass() {
    const int blocks = blocks_ - bake_->blocks() + (bake_->blocks() == before_ ? 2 : 1);
    progress_.expect(progress_.work() + bake_->cost() * blocks + scene_.cost_of_walls());
  }

  Baked<D> run_passes() {
    for (;;) {
      // The first picture is a complete bake.
      if (chosen_ == Texels::preview && passes_ <= 1 && schedule_.ends_with_preview()) {
        return last(bake_so_far(*bake_), true);
      }
      add_blocks();
      if (is_too_short()) {
        if (chosen_ == Texels::fine) return last_of_usual_texels();
        begin(chosen_ == Texels::usual ? wider_in_time() : Texels::preview);
        continue;
      }
      preview_.reset();
      preview_walls_.reset();
      ++passes_;
      Baked<D> baked = bake_so_far(*bake_);
      const EndedPass pass{bake_->blocks(), blocks_, errors_.all()};
      const bool refines = schedule_.wants_finer_texels(pass) && has_fine_texels();
      const NextStep step = refines ? NextStep::more_blocks : schedule_.after(pass);
      if (step != NextStep::more_blocks)
        return last(std::move(baked), step == NextStep::end_unfinished);
      show(std::move(baked));
      if (refines) {
        // The result if the time ends before the first blocks of fine texels.
        preview_ = std::move(bake_);
        begin(Texels::fine);
        continue;
      }
      // Out of time: the result is the bake that was shown.
      if (schedule_.is_late()) return last(bake_so_far(*bake_), true);
      blocks_ = schedule_.blocks_after(pass);
    }
  }

  void add_blocks() {
    schedule_.begin_block();
    expect_pass();
    bake_->add(blocks_ - bake_->blocks(), [this] { return go_on(); });
  }

  // True if the time ended so early that another picture is the result, or coarser texels are.
  bool is_too_short() const {
    const int blocks = bake_->blocks();
    return blocks < blocks_ && preview_ && PassSchedule::is_too_short(blocks - before_);
  }

  void show(Baked<D>&& baked) {
    if (!hooks_.on_pass) return;
    // If isosurfaces store no light, only the walls are visible.
    if (schedule_.texels == 0) baked.walls = walls(*bake_);
    hooks_.on_pass(std::move(baked));
  }

  // Gives up fine texels whose first blocks have no time.
  Baked<D> last_of_usual_texels() {
    chosen_ = Texels::usual;
    bake_ = std::move(preview_);
    return last(bake_so_far(*bake_), true);
  }

  // True if there are finer texels, and the time suffices for them.
  bool has_fine_texels() {
    if (chosen_ != Texels::usual || previous_ || !scene_.plan.lines) return false;
    // Lines light one volume.
    const LineVolume<D>& volume = scene_.volumes[0];
    const PassResolutions<D> fine = pass_resolutions(volume.volume().field, volume.isovalue_range(),
                                                     scene_.settings, Texels::fine);
    if (fine.indirect == indirect_resolution_) return false;
    fine_ = texels_of(scene_, Texels::fine);
    if (fits(fine_)) return true;
    fine_.clear();
    return false;
  }

  // Saves a checkpoint after a block if one is due. True if time is left for another block.
  bool go_on() {
    schedule_.end_block();
    const Checkpoints* checkpoints = hooks_.checkpoints;
    if (checkpoints && checkpoints->save &&
        schedule_.now() - saved_ + schedule_.took.block >= checkpoints->seconds) {
      checkpoints->save([this](std::ostream& stream) { serialize(Archive(stream)); });
      saved_ = schedule_.now();
    }
    return schedule_.goes_on(bake_->blocks() - before_, preview_ != nullptr);
  }

  void serialize(Archive archive) {
    // Numbers are stored in the memory layout of this build.
    int layout = sizeof(Real) * 256 + D;
    const int own_layout = layout;
    archive(layout);
    if (layout != own_layout) throw Error("The checkpoint is of another version; bake again.");
    archive(chosen_);
    archive(scene_.wall_detail.samples);
    archive(scene_.wall_detail.share);
    archive(schedule_.took.fine_walls);
    if (archive.restores()) begin(chosen_);
    const std::uint64_t before = rays();
    std::uint64_t traced = before;
    archive(traced);
    archive(passes_);
    archive(blocks_);
    bake_->serialize(archive);
    progress_.count_rays(traced - before);
  }

  std::uint64_t rays() const { return progress_.rays() - first_rays_; }

  Baked<D> bake_so_far(Integrator<D>& bake) {
    const double began = schedule_.now();
    Baked<D> baked;
    baked.grids = bake.grids();
    std::size_t texels = 0;
    for (const RadianceGrid<D>& grid : baked.grids) texels += grid.texels();
    schedule_.took.texel =
        (schedule_.now() - began) / static_cast<double>(std::max<std::size_t>(1, texels));
    baked.statistics.rays = rays();
    baked.statistics.passes = passes_;
    baked.statistics.blocks = bake.blocks();
    baked.statistics.continued = previous_ != nullptr;
    errors_ = bake.errors();
    measured_->take_shared();
    measured_->add_to(errors_, baked.grids);
    const IsovalueError error = errors_.all();
    baked.statistics.noise_percent = 100 * std::sqrt(error.noise);
    baked.statistics.error_percent = error.percent();
    baked.statistics.worst = errors_.worst();
    return baked;
  }

  WallRadiance<D> walls(Integrator<D>& bake) {
    scene_.compute_wall_direct_light();
    const double began = schedule_.now();
    WallRadiance<D> walls = bake.walls();
    schedule_.took.walls = schedule_.now() - began;
    return walls;
  }

  // Finishes the last pass, which includes the walls.
  Baked<D> last(Baked<D> baked, bool stopped) {
    if (!schedule_.is_over(schedule_.took.fine_walls)) scene_.wall_detail = WallDetail();
    const bool is_known = scene_.wall_detail.share > 1 && preview_walls_;
    if (scene_.plan.walls) baked.walls = is_known ? *std::move(preview_walls_) : walls(*bake_);
    BakeStatistics& statistics = baked.statistics;
    statistics.rays = rays();
    statistics.passes = std::max(1, passes_);
    statistics.stopped = stopped;
    if (!schedule_.is_limited() || progress_.stopped()) return baked;
    if (chosen_ == Texels::wide || chosen_ == Texels::preview) {
      statistics.stopped = stopped || statistics.error_percent > scene_.settings.error;
      statistics.skipped.push_back(finer_texels<D>(baked.grids[0].lattice.resolution));
    }
    if (scene_.wall_detail.share > 1) statistics.skipped.push_back(finer_walls());
    return baked;
  }

  PassSchedule schedule_;
  const BakeHooks<D>& hooks_;
  LitScene<D> scene_;
  Progress& progress_;
  const std::uint64_t first_rays_ = progress_.rays();  // rays before this bake
  const Previous* previous_ = nullptr;                 // null: none
  std::vector<BakeTexels<D>> texels_, wider_, fine_;   // until the integrator has them
  std::vector<Index<D>> shown_;                        // their resolutions
  Index<D> indirect_resolution_{};                     // that of the first volume's indirect light
  std::size_t preview_texels_ = 1;                     // number of those of indirect light
  Texels chosen_ = Texels::usual, previous_texels_ = Texels::usual;
  // Number of passes, of blocks of the previous bake, and of blocks after this pass.
  int passes_ = 0, before_ = 0, blocks_ = 0;
  double saved_ = 0;  // when the last checkpoint was saved
  std::unique_ptr<Integrator<D>> preview_, bake_;
  std::optional<WallRadiance<D>> preview_walls_;
  std::optional<MeasuredError<D>> measured_;
  IsovalueErrors errors_;  // of the last complete bake
};

}  // namespace

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

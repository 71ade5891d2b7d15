// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/rounds.h"

#include <chrono>
#include <cmath>

#include "leaflight/bake/swept_bake.h"
#include "leaflight/math/error.h"
#include "leaflight/transport/placement.h"

namespace leaflight {
namespace {

// Texels that a bake has by default, at most, where they are finer than voxels.
constexpr std::size_t most_finer_texels = 2'500'000;
constexpr int most_halvings = 2;
// Where leaves pass more voxels than these, soft light's lines are two texels apart, its texels are
// coarser than voxels, those that photons fall into are.
constexpr std::size_t most_dense_voxels = 200'000, most_soft_voxels = 20'000'000,
                      most_photon_voxels = 300'000;
constexpr int widest_texel = 8;
// A first picture has texels so many voxels wide; bakes of fewer texels do without.
constexpr int preview_width = 4;
constexpr std::size_t most_without_preview = 200'000;
// Photons tell of the light that has bounced more than once before sweeps know it, and of the soft
// light of the surroundings.
constexpr std::uint64_t photons = 400'000, preview_photons = 20'000;
// Blocks of sweeps of the first round; at least so many in the end, since their differences tell
// the error; and at most.
constexpr int first_blocks = 2, least_blocks = 4, most_blocks = 32;
// What noise may be of the error that is asked for: what the texels' width leaves of it, within
// these shares, as more sweeps do not mend texels.
constexpr double least_noise = 0.5, most_noise = 0.8;

// A lattice with texels of so many voxels.
template <int D>
TexelLattice<D> lattice_of(const SweptVolume<D>& volume, int voxels_per_texel) {
  const Field<D>& field = volume.volume().field;
  const IsovalueWindow window = volume.window();
  Index<D> resolution;
  for (int a = 0; a < D; ++a) {
    resolution[a] = std::max(2, (field.dims[a] - 1 + voxels_per_texel - 1) / voxels_per_texel + 1);
  }
  return make_lattice(field, resolution, window.min, window.max);
}

// The texels of the result: as the settings say, else voxels, or finer where they are few.
template <int D>
TexelLattice<D> result_lattice(const SweptVolume<D>& volume, const BakeSettings<D>& settings) {
  const Field<D>& field = volume.volume().field;
  const IsovalueWindow window = volume.window();
  if (settings.resolution != Index<D>{}) {
    return make_lattice(field, settings.resolution, window.min, window.max);
  }
  TexelLattice<D> lattice = lattice_of(volume, 1);
  for (int i = 0; i < most_halvings && lattice.active.size() << D <= most_finer_texels; ++i) {
    Index<D> finer;
    for (int a = 0; a < D; ++a) finer[a] = 2 * lattice.resolution[a] - 1;
    lattice = make_lattice(field, finer, window.min, window.max);
  }
  return lattice;
}

// How wide texels are for leaves to pass at most so many, given the voxels that they pass.
int width_for(std::size_t voxels, std::size_t most, int dimension) {
  int width = 1;
  while (width < widest_texel && voxels > most) {
    width *= 2;
    voxels >>= dimension;
  }
  return width;
}

template <int D>
SweptTexels<D> texels_of(const SweptVolume<D>& volume, const BakeSettings<D>& settings) {
  SweptTexels<D> texels;
  texels.direct = SweptLattice<D>(result_lattice(volume, settings));
  const std::size_t voxels = lattice_of(volume, 1).active.size();
  // Soft light needs no texels finer than voxels.
  texels.soft = SweptLattice<D>(lattice_of(volume, width_for(voxels, most_soft_voxels, D)));
  texels.spacing = voxels > most_dense_voxels ? 2 : 1;
  texels.photons = lattice_of(volume, width_for(voxels, most_photon_voxels, D));
  texels.photon_count = photons;
  return texels;
}

template <int D>
SweptTexels<D> preview_texels(const SweptVolume<D>& volume) {
  SweptTexels<D> texels;
  texels.photons = lattice_of(volume, preview_width);
  texels.direct = texels.soft = SweptLattice<D>(texels.photons);
  texels.photon_count = preview_photons;
  return texels;
}

// Blocks of direct and of indirect light.
struct Blocks {
  int direct, indirect;

  bool enough() const {
    return direct >= least_blocks && (indirect == 0 || indirect >= least_blocks);
  }
};

// The blocks after the next round: those for which the work is least that leaves the noise
// `target`, a variance, by what was found so far; at most twice as many as now.
template <int D>
Blocks next_blocks(const SweptBake<D>& bake, double target) {
  const int direct = bake.direct_blocks(), indirect = bake.indirect_blocks();
  // Variance times work of one block.
  const double own = bake.direct_noise() * direct * bake.direct_cost();
  const double soft = bake.indirect_noise() * indirect * bake.indirect_cost();
  const double both = (std::sqrt(own) + std::sqrt(soft)) / target;
  const auto next = [&](int now, double product, double cost) {
    const int least = std::max(now, std::min(least_blocks, 2 * now));
    const int most = std::max(least, std::min(2 * now, most_blocks));
    const double wanted = cost > 0 ? std::sqrt(product) / cost * both : 0;
    return static_cast<int>(std::clamp<double>(std::ceil(wanted), least, most));
  };
  return {next(direct, own, bake.direct_cost()), next(indirect, soft, bake.indirect_cost())};
}

}  // namespace

template <int D>
bool fits_rounds(const Scene<D>& scene, const BakeSettings<D>& settings, const Plan& plan) {
  return settings.samples == 0 && settings.estimator == EstimatorName::gather &&
         !settings.scattered && settings.only_at.empty() && scene.volumes.size() == 1 &&
         scene.volumes[0].scattering == Scattering::diffuse && !plan.specular;
}

template <int D>
Baked<D> bake_in_rounds(const Scene<D>& scene, const BakeSettings<D>& settings, const Plan& plan,
                        Progress& progress, const OnRound<D>& on_round) {
  const auto start = std::chrono::steady_clock::now();
  const SceneTracer<D> tracer(scene);
  check_placement(tracer);
  const LightSampler<D> lights(tracer);
  const std::vector<Vec<D, float>> gradients =
      voxel_gradients(scene.volumes[0].field, inverse(tracer.index_to_frame(0)));
  const SweptVolume<D> volume{tracer, 0, gradients};
  progress.check();
  SweptTexels<D> texels = texels_of(volume, settings);
  progress.check();
  const std::size_t count = texels.direct.lattice.active.size();
  if (count == 0) {
    throw Error(
        "No isosurface of the isovalue window passes through the volume; widen the window.");
  }
  // Until sweeps know what they cost.
  progress.expect(least_blocks * static_cast<double>(texels.direct.lattice.texels()) *
                  (DirectLight<D>::sources_per_block +
                   IndirectLight<D>::directions_per_block / std::pow(texels.spacing, D - 1)));
  std::atomic<std::uint64_t> rays{0};
  int rounds = 0;
  const auto whole = [&](SweptBake<D>& bake) {
    Baked<D> baked;
    baked.grids.push_back(bake.grid());
    baked.statistics.rays = rays;
    baked.statistics.rounds = rounds;
    const double noise = bake.direct_noise() + bake.indirect_noise();
    baked.statistics.noise_percent = 100 * std::sqrt(noise);
    baked.statistics.error_percent = 100 * std::sqrt(noise + bake.texture_error());
    return baked;
  };
  const auto ended = [&] {
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    return progress.stopped() || (settings.seconds > 0 && seconds.count() > settings.seconds);
  };
  // A bake's last round, which has the surroundings, too.
  const auto last = [&](SweptBake<D>& bake, Baked<D> baked, bool stopped) {
    if (plan.surroundings) baked.surroundings = bake.surroundings();
    baked.statistics.rays = rays;
    baked.statistics.stopped = stopped;
    return baked;
  };
  if (count > most_without_preview) {
    ++rounds;
    if (on_round) {
      SweptBake<D> preview(volume, lights, settings, plan, progress, rays, preview_texels(volume));
      preview.add(first_blocks, first_blocks);
      on_round(whole(preview));
      if (ended()) return last(preview, whole(preview), true);
    }
  }
  SweptBake<D> bake(volume, lights, settings, plan, progress, rays, std::move(texels));
  const double asked = std::pow(settings.error / 100, 2);
  Blocks blocks{first_blocks, plan.indirect ? first_blocks : 0};
  for (;;) {
    progress.expect(bake.direct_cost() * std::max(blocks.direct, least_blocks) +
                    bake.indirect_cost() * std::max(blocks.indirect + 1, least_blocks));
    bake.add(blocks.direct - bake.direct_blocks(), blocks.indirect - bake.indirect_blocks());
    ++rounds;
    Baked<D> baked = whole(bake);
    const double texture = bake.texture_error();
    const double least = least_noise * least_noise * std::max(asked, texture);
    const double target =
        std::clamp(asked - texture, least, std::max(least, most_noise * most_noise * asked));
    const Blocks next = next_blocks(bake, target);
    const bool reached = blocks.enough() && bake.direct_noise() + bake.indirect_noise() <= target;
    const bool more = next.direct > blocks.direct || next.indirect > blocks.indirect;
    if (reached || !more) return last(bake, std::move(baked), false);
    if (ended()) return last(bake, std::move(baked), true);
    if (on_round) on_round(std::move(baked));
    // What was shown is what is left.
    if (ended()) return last(bake, whole(bake), true);
    blocks = next;
  }
}

template bool fits_rounds<2>(const Scene<2>&, const BakeSettings<2>&, const Plan&);
template bool fits_rounds<3>(const Scene<3>&, const BakeSettings<3>&, const Plan&);
template Baked<2> bake_in_rounds<2>(const Scene<2>&, const BakeSettings<2>&, const Plan&, Progress&,
                                    const OnRound<2>&);
template Baked<3> bake_in_rounds<3>(const Scene<3>&, const BakeSettings<3>&, const Plan&, Progress&,
                                    const OnRound<3>&);

}  // namespace leaflight

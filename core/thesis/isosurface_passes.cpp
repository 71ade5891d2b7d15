// SPDX-License-Identifier: GPL-3.0-or-later
#include "thesis/isosurface_passes.h"

#include "bake/texels/texel_surface.h"
#include "thesis/photon_estimator.h"
#include "thesis/scattered_averages.h"

namespace leaflight {
namespace {

// Averages radiance(point, keys, i, rays) over the samples of each texel, or over scattered ones.
// Without randomness, one estimate at each scattered point suffices.
template <int D, class Radiance>
std::vector<Average> average_isosurfaces(FixedBake<D>& bake, const IsosurfaceTexels<D>& texels,
                                         double rays_per_sample, bool is_random,
                                         Radiance radiance) {
  IsosurfaceSamples samples{texels.volume, texels.back, bake.settings.samples, rays_per_sample,
                            bake.settings.seed};
  if (!bake.scattered || texels.lattice.active.empty()) {
    return average_texels(bake.tracer, texels.lattice, samples, bake.progress, radiance);
  }
  if (!is_random) samples.count = 1;
  return average_scattered(bake.tracer, texels.lattice, samples,
                           bake.scattered->positions[texels.volume], bake.scattered->filter,
                           bake.progress, radiance);
}

// Adds the variance that all samples of a texel share, which their spread cannot show.
template <int D>
void add_shared_variance(const FixedBake<D>& bake, const IsosurfaceTexels<D>& texels,
                         const PhotonEstimator<D>* estimator, std::vector<Average>& averages) {
  const Volume<D>& scene_volume = bake.tracer.scene().volumes[texels.volume];
  for (std::size_t s = 0; s < averages.size(); ++s) {
    const Vec<D> center = texels.lattice.center(texels.lattice.active[s]);
    const IsosurfaceTexel<D> texel{texels.volume, texels.back, center,
                                   texel_albedo(scene_volume, texels.lattice, s)};
    if (estimator) averages[s].variance += estimator->shared_variance(texel, averages[s].mean);
    if (bake.plan.caustics) averages[s].variance += caustic_variance(bake.isosurfaces, texel);
  }
}

}  // namespace

template <int D>
std::vector<Average> direct_pass(FixedBake<D>& bake, const IsosurfaceTexels<D>& texels) {
  const PointSampler<D> from = bake.sampler();
  return average_isosurfaces(
      bake, texels, 1, true,
      [&](const SurfacePoint<D>& point, const SampleKeys& keys, int i, std::uint64_t& rays) {
        return from.direct(point, keys, i, rays);
      });
}

template <int D>
std::vector<Average> indirect_pass(FixedBake<D>& bake, const IsosurfaceTexels<D>& texels,
                                   const IndirectEstimator<D>* estimator) {
  const PointSampler<D> from = bake.sampler();
  std::vector<Average> averages(texels.lattice.active.size());
  const auto* of_photons = dynamic_cast<const PhotonEstimator<D>*>(estimator);
  const bool glows = bake.tracer.scene().volumes[texels.volume].emission.largest() > 0;
  if (estimator || bake.plan.caustics || glows) {
    averages = average_isosurfaces(
        bake, texels, estimator ? bake.indirect_rays() : 0, estimator && !of_photons,
        [&](const SurfacePoint<D>& point, const SampleKeys& keys, int i, std::uint64_t& rays) {
          return from.indirect(point, estimator, keys, i, rays);
        });
  }
  add_shared_variance(bake, texels, of_photons, averages);
  return averages;
}

template std::vector<Average> direct_pass(FixedBake<2>&, const IsosurfaceTexels<2>&);
template std::vector<Average> direct_pass(FixedBake<3>&, const IsosurfaceTexels<3>&);
template std::vector<Average> indirect_pass(FixedBake<2>&, const IsosurfaceTexels<2>&,
                                            const IndirectEstimator<2>*);
template std::vector<Average> indirect_pass(FixedBake<3>&, const IsosurfaceTexels<3>&,
                                            const IndirectEstimator<3>*);

}  // namespace leaflight

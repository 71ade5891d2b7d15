// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/fixed/soft_records.h"

#include <algorithm>

#include "bake/texels/leaf_averages.h"

namespace leaflight {
namespace {

template <int D>
TexelLattice<D> lattice_of_records(const Volume<D>& volume, const IsovalueWindow& leaves,
                                   const TexelLattice<D>& texels, int spacing) {
  const IsovalueWindow window = volume.isovalues(leaves);
  return make_lattice(volume.field, coarser_resolution<D>(texels.resolution, spacing), window.min,
                      window.max);
}

}  // namespace

template <int D>
std::vector<Average> soft_from_records(FixedBake<D>& bake, const LeafTexels<D>& texels,
                                       const IndirectEstimator<D>& estimator) {
  const Scene<D>& scene = bake.tracer.scene();
  const Volume<D>& of = scene.volumes[texels.volume];
  const int spacing = bake.settings.soft_spacing;
  const TexelLattice<D> coarse = lattice_of_records(of, scene.window, texels.lattice, spacing);
  const PointSampler<D> from = bake.sampler();
  const LeafSamples samples{texels.volume, texels.above, bake.settings.samples * spacing * spacing,
                            bake.soft_rays(), bake.settings.seed};
  const std::vector<Average> records = average_texels(
      bake.tracer, coarse, samples, bake.progress, bake.rays,
      [&](const SurfacePoint<D>& point, const SampleKeys& keys, int i, std::uint64_t& rays) {
        SurfacePoint<D> white = point;
        white.albedo = Rgb(1);
        return from.soft(white, estimator, keys, i, rays);
      });
  std::vector<Average> soft(texels.lattice.active.size());
  parallel_range(soft.size(), 1024, 0, bake.progress, [&](std::size_t begin, std::size_t end) {
    for (std::size_t s = begin; s < end; ++s) {
      const Vec<D> centre = texels.lattice.centre(texels.lattice.active[s]);
      const TexelWeights<D> weights = linear_weights(coarse, centre);
      for (int i = 0; i < (1 << D); ++i) {
        if (!(weights.weight[i] > 0)) continue;
        const Average& record = records[weights.slot[i]];
        soft[s].mean += record.mean * weights.weight[i];
        soft[s].variance += record.variance * weights.weight[i] * weights.weight[i];
      }
      const Rgb albedo = albedo_near(of, centre);
      soft[s].mean *= albedo;
      soft[s].variance *= static_cast<float>(average(albedo) * average(albedo));
    }
  });
  return soft;
}

template std::vector<Average> soft_from_records(FixedBake<2>&, const LeafTexels<2>&,
                                                const IndirectEstimator<2>&);
template std::vector<Average> soft_from_records(FixedBake<3>&, const LeafTexels<3>&,
                                                const IndirectEstimator<3>&);

}  // namespace leaflight

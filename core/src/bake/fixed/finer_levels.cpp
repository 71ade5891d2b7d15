// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/fixed/finer_levels.h"

#include "bake/fixed/leaf_passes.h"
#include "bake/fixed/refinement.h"

namespace leaflight {

template <int D>
void add_finer_levels(FixedBake<D>& bake, int volume, const IndirectEstimator<D>* estimator,
                      RadianceGrid<D>& grid) {
  const Scene<D>& scene = bake.tracer.scene();
  const Volume<D>& of = scene.volumes[volume];
  const IsovalueWindow window = of.isovalues(scene.window);
  for (int level = 1; level <= bake.settings.refine; ++level) {
    const auto cells = cells_to_refine(of.field, window, grid, bake.settings.exposure);
    FinerTexels<D> texels = finer_texels(of.field, window, grid, cells);
    if (texels.all.active.empty()) return;
    SideAverages direct, indirect;
    for (int side = 0; side < bake.sides(); ++side) {
      const LeafTexels<D> sampled{volume, side != 0, texels.sampled, level};
      direct[side] = direct_pass(bake, sampled);
      indirect[side] = indirect_pass(bake, sampled, estimator);
    }
    grid.finer.push_back(
        finer_level(grid, std::move(texels), make_grid<D>(std::move(direct), std::move(indirect))));
  }
}

template void add_finer_levels(FixedBake<2>&, int, const IndirectEstimator<2>*, RadianceGrid<2>&);
template void add_finer_levels(FixedBake<3>&, int, const IndirectEstimator<3>*, RadianceGrid<3>&);

}  // namespace leaflight

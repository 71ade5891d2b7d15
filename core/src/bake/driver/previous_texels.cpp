// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/previous_texels.h"

#include "base/error.h"

namespace leaflight {
namespace {

template <int D>
bool has_resolution(const LitScene<D>& scene, const std::vector<BakeTexels<D>>& texels,
                    const std::vector<PreviousLight<D>>& previous) {
  for (std::size_t v = 0; v < std::min(texels.size(), previous.size()); ++v) {
    if (!scene.stores_light_of(v)) continue;
    if (previous[v].resolution() != texels[v].shown.lattice.resolution) return false;
  }
  return true;
}

template <int D>
bool fits(const LitScene<D>& scene, const std::vector<BakeTexels<D>>& texels,
          const std::vector<PreviousLight<D>>& previous) {
  if (previous.size() != texels.size()) return false;
  if (!scene.plan.indirect) return true;
  for (std::size_t v = 0; v < texels.size(); ++v) {
    if (!scene.stores_light_of(v)) continue;
    if (!previous[v].fits(texels[v].shown.lattice, texels[v].indirect.lattice, scene.plan.back))
      return false;
  }
  return true;
}

}  // namespace

template <int D>
std::vector<BakeTexels<D>> texels_of(const LitScene<D>& scene, Texels kind) {
  std::vector<BakeTexels<D>> texels;
  for (const LineVolume<D>& volume : scene.volumes) {
    texels.push_back(scene.plan.lines ? pass_texels(volume, scene.settings, kind)
                                      : ray_texels(volume, scene.settings, kind));
  }
  return texels;
}

template <int D>
std::optional<Texels> previous_texels(const LitScene<D>& scene,
                                      const std::vector<PreviousLight<D>>& previous) {
  bool is_known = false;
  for (const Texels kind : {Texels::usual, Texels::fine}) {
    const std::vector<BakeTexels<D>> texels = texels_of(scene, kind);
    if (!has_resolution(scene, texels, previous)) continue;
    if (fits(scene, texels, previous)) return kind;
    is_known = true;
  }
  if (!is_known) return {};
  throw Error(
      "The bake to continue is of another volume, isovalue range or other sides; bake the volume "
      "anew.");
}

template std::vector<BakeTexels<2>> texels_of(const LitScene<2>&, Texels);
template std::vector<BakeTexels<3>> texels_of(const LitScene<3>&, Texels);
template std::optional<Texels> previous_texels(const LitScene<2>&,
                                               const std::vector<PreviousLight<2>>&);
template std::optional<Texels> previous_texels(const LitScene<3>&,
                                               const std::vector<PreviousLight<3>>&);

}  // namespace leaflight

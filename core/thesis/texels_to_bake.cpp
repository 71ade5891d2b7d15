// SPDX-License-Identifier: GPL-3.0-or-later
#include "thesis/texels_to_bake.h"

namespace leaflight {
namespace {

// True if texels can store light. Reflections of mirrors and glass depend on the view.
template <int D>
bool is_stored(const Volume<D>& volume) {
  return volume.scattering == Scattering::diffuse;
}

// Leaves active only the texels that lookups at these index positions may use.
template <int D>
void restrict_to_lookups(TexelLattice<D>& lattice, const std::vector<Vec<D>>& index_positions) {
  std::vector<bool> used(lattice.texels(), false);
  for (const Vec<D>& position : index_positions) {
    const Index<D> low = lattice.cell_point(position).cell;
    Index<D> high = low;
    for (int& n : high) n += 2;
    for_each_index<D>(low, high,
                      [&](const Index<D>& texel) { used[lattice.linear(texel)] = true; });
  }
  std::vector<std::uint32_t> active;
  for (const std::uint32_t texel : lattice.active) {
    if (used[texel]) active.push_back(texel);
  }
  lattice.activate(std::move(active));
}

template <int D>
TexelLattice<D> lattice_of(const Volume<D>& volume, const IsovalueRange& isosurfaces,
                           const FixedSettings<D>& settings) {
  const Field<D>& field = volume.field;
  const Index<D> resolution = settings.resolution == Index<D>{} ? field.dims : settings.resolution;
  if (!is_stored(volume)) return inactive_lattice<D>(field.dims, resolution);
  const IsovalueRange isovalue_range = volume.isovalues(isosurfaces);
  TexelLattice<D> lattice = make_lattice(field, resolution, isovalue_range.min, isovalue_range.max);
  if (settings.only_at.empty()) return lattice;
  std::vector<Vec<D>> positions;
  for (const Vec<D>& point : settings.only_at) {
    positions.push_back(field.world_to_index.point(point));
  }
  restrict_to_lookups(lattice, positions);
  return lattice;
}

}  // namespace

template <int D>
std::vector<TexelLattice<D>> texels_to_bake(const Scene<D>& scene, const FixedSettings<D>& settings,
                                            const Plan& plan) {
  std::vector<TexelLattice<D>> lattices;
  bool any = plan.walls;
  for (const Volume<D>& volume : scene.volumes) {
    lattices.push_back(lattice_of(volume, scene.isovalue_range, settings));
    any = any || !lattices.back().active.empty();
  }
  if (!any) throw nothing_to_bake(scene);
  return lattices;
}

template <int D>
std::optional<ScatteredSamples<D>> scattered_samples(const Scene<D>& scene,
                                                     const FixedSettings<D>& settings) {
  if (!settings.scattered) return {};
  const ScatteredBake& asked = *settings.scattered;
  SampleSettings samples = asked.samples;
  samples.seed = settings.seed;
  ScatteredSamples<D> scattered{{}, asked.filter};
  for (const Volume<D>& volume : scene.volumes) {
    auto& positions = scattered.positions.emplace_back();
    if (!is_stored(volume)) continue;
    positions = sample_positions(volume.field, volume.isovalues(scene.isovalue_range), samples);
  }
  return scattered;
}

template std::vector<TexelLattice<2>> texels_to_bake(const Scene<2>&, const FixedSettings<2>&,
                                                     const Plan&);
template std::vector<TexelLattice<3>> texels_to_bake(const Scene<3>&, const FixedSettings<3>&,
                                                     const Plan&);
template std::optional<ScatteredSamples<2>> scattered_samples(const Scene<2>&,
                                                              const FixedSettings<2>&);
template std::optional<ScatteredSamples<3>> scattered_samples(const Scene<3>&,
                                                              const FixedSettings<3>&);

}  // namespace leaflight

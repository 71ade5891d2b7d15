// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>

#include "bake/indirect/line_walk.h"
#include "bake/texels/line_volume.h"
#include "base/random.h"
#include "field/shading_gradient.h"

namespace leaflight {

// The points at which lines cross the isosurfaces on the cap of a cut, for each layer of texels.
// All directions must reach each layer alike. Samples at the planes of a line would not, because a
// cap is only a voxel wide, and its layers lie between planes.
template <int D>
struct CapCrossings {
  const LineVolume<D>& volume;
  const TexelLattice<D>& lattice;  // with layers
  std::uint64_t key;
  bool back;  // true if lines gather for backs, too
  const Field<D>& field = volume.volume().field;
  const IsovalueRange range = volume.isovalue_range();
  const double per_range = 1 / (static_cast<double>(field.max) - field.min);

  // True if the isosurface of value h lies on a cap at a position in texels.
  bool holds(const Vec<D>& position, float h) const {
    if (lattice.capped[nearest_texel(lattice, position)] == TexelLattice<D>::inactive) return false;
    return is_on_cut(field, locate(field, position * lattice.voxels_per_texel), h);
  }
  // Calls visit(LineSample) for one isosurface of each layer that the line crosses between plane k
  // and the one before, in the order of the walk. The weight is the part of the layer's values.
  template <class Visit>
  void for_each(const LineBundle<D>& line, const Walk<D>& walk, int k,
                const GatherLines<D>& scratch, Visit visit) const {
    const double before = scratch.h[k - walk.step], after = scratch.h[k];
    const bool front = after > before;
    if (!front && !(back && after < before)) return;
    const double z = line.z(k - walk.step), step = line.z(k) - z;
    const std::size_t texel = nearest_texel(lattice, line.position(walk.lane, z + step / 2));
    if (lattice.capped[texel] == TexelLattice<D>::inactive) return;
    const double low = std::max(std::min(before, after), range.min);
    const double high = std::min(std::max(before, after), range.max);
    for (int i = 0; i < lattice.layers; ++i) {
      const int layer = front ? i : lattice.layers - 1 - i;
      const double bottom = std::max(low, lattice.layer_low(layer));
      const double top = std::min(high, lattice.layer_low(layer + 1));
      if (!(bottom < top)) continue;
      const std::uint64_t bits = Random::mix(key ^ (texel * lattice.layers + layer));
      const double h = bottom + (top - bottom) * static_cast<double>(bits >> 11) * 0x1p-53;
      const double place = z + step * (h - before) / (after - before);
      const auto value = static_cast<float>(h);
      if (!holds(line.position(walk.lane, place), value)) continue;
      const std::int32_t slot = slot_near(line, walk, place, layer, scratch);
      if (slot == TexelLattice<D>::inactive) continue;
      const double weight = (top - bottom) * per_range / (std::abs(step) * walk.length);
      visit(LineSample{place, value, static_cast<float>(weight), front, slot});
    }
  }

 private:
  // Returns the slot of a layer of the texel nearest to z that this line serves, or inactive.
  std::int32_t slot_near(const LineBundle<D>& line, const Walk<D>& walk, double z, int layer,
                         const GatherLines<D>& scratch) const {
    const double per_texel = 1 / (line.z(1) - line.z(0));
    const int nearest = static_cast<int>(std::lround(z * per_texel));
    const int reach = std::max(1, static_cast<int>(std::ceil(per_texel / 2)));
    for (int d = 0; d <= reach; ++d) {
      for (const int k : {nearest - d, nearest + d}) {
        if (k < line.first(walk.lane) || k > line.last(walk.lane)) continue;
        const std::int32_t texel = scratch.slots[k][walk.lane];
        if (texel == TexelLattice<D>::inactive) continue;
        const std::int32_t slot = lattice.layer_slot(lattice.active[texel], layer);
        if (slot != TexelLattice<D>::inactive) return slot;
      }
    }
    return TexelLattice<D>::inactive;
  }
};

}  // namespace leaflight

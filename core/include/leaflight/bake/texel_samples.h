// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "leaflight/field/texel_lattice.h"
#include "leaflight/math/low_discrepancy.h"
#include "leaflight/math/random.h"
#include "leaflight/trace/scene_tracer.h"

namespace leaflight {

// Calls visit(SurfacePoint, i) for up to `samples` points i = 0, 1, ... of a texel, seen from the
// given side, uniform in the volume: a point x lies on the leaf c = h(x), so this samples the graph
// of h (thesis 4.5), and all leaves through the texel at once. Points whose leaf is outside the
// window, in a masked cell or without a gradient are passed over. Where the texel's own box holds
// too few, the neighbourhood that a trilinear lookup can reach is searched. Returns the number of
// points visited.
template <int D, class Visit>
int for_each_texel_sample(const SceneTracer<D>& tracer, int volume, bool above,
                          const TexelLattice<D>& lattice, std::uint32_t texel, int samples,
                          std::uint64_t key, Visit visit) {
  constexpr int tries_per_sample = 16;
  // The lookup's interpolation blurs once more, so a texel averages over less than its own box;
  // 0.25 to 0.5 measure alike on smooth surfaces, and less is better on thin shells
  // (docs/architecture.md).
  constexpr double own_half_width = 0.35;
  const Volume<D>& of = tracer.scene().volumes[volume];
  const Field<D>& field = of.field;
  const Index<D> index = lattice.texel(texel);
  int visited = 0;
  for (const double half_width : {own_half_width, 1.0}) {
    for (int i = 0; i < tries_per_sample * samples && visited < samples; ++i) {
      const auto xy = sobol_point(i, key);
      const auto z = sobol_point(i, ~key);
      Vec<D> position;
      for (int a = 0; a < D; ++a) {
        const double low = std::max(index[a] - half_width, 0.0);
        const double high = std::min(index[a] + half_width, lattice.resolution[a] - 1.0);
        const double u = a < 2 ? xy[a] : z[0];
        position[a] = (low + (high - low) * u) * lattice.voxels_per_texel[a];
      }
      const CellPoint<D> point = locate(field, position);
      const double h = interpolate(load_corners(field, point.cell), point.local);
      const double c = of.leaf_coordinate(h);
      if (!tracer.scene().window.contains(c)) continue;
      const SurfacePoint<D> surface = tracer.leaf_point(volume, point, c, above);
      if (surface.kind == HitKind::none) continue;
      visit(surface, visited++);
    }
  }
  return visited;
}

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "base/low_discrepancy.h"
#include "base/random.h"
#include "field/texel_lattice.h"
#include "trace/scene_tracer.h"

namespace leaflight {

// A box around a texel of a lattice, clamped to the field. `half_width`: in texels.
template <int D>
struct TexelBox {
  Vec<D> low, high;  // index coordinates

  TexelBox(const TexelLattice<D>& lattice, std::uint32_t number, double half_width) {
    const Index<D> texel = lattice.texel(number);
    for (int a = 0; a < D; ++a) {
      const double step = lattice.voxels_per_texel[a];
      low[a] = std::max(texel[a] - half_width, 0.0) * step;
      high[a] = std::min(texel[a] + half_width, lattice.resolution[a] - 1.0) * step;
    }
  }
  Vec<D> point(std::uint32_t i, std::uint64_t key) const {
    const auto xy = sobol_point(i, key);
    const auto z = sobol_point(i, ~key);
    Vec<D> position;
    for (int a = 0; a < D; ++a) position[a] = low[a] + (high[a] - low[a]) * (a < 2 ? xy[a] : z[0]);
    return position;
  }
  bool contains(const Vec<D>& position) const {
    for (int a = 0; a < D; ++a) {
      if (!(low[a] <= position[a] && position[a] <= high[a])) return false;
    }
    return true;
  }
};

// Moves a position along the gradient to about the isosurface of an isovalue, by Newton's method.
template <int D>
Vec<D> moved_to_isosurface(const Field<D>& field, Vec<D> position, double isovalue) {
  constexpr int steps = 8;
  for (int i = 0; i < steps; ++i) {
    const CellPoint<D> point = locate(field, position);
    const CellCorners<D> corners = load_corners(field, point.cell);
    const Vec<D> gradient = geometric_gradient(corners, point.local);
    const double length = gradient.length();
    if (!(length > 0)) break;  // flat or masked
    position += gradient / length * ((isovalue - interpolate(corners, point.local)) / length);
  }
  return position;
}

// Calls visit(SurfacePoint, i) for up to `samples` points i = 0, 1, ... of a texel, seen from the
// given side. Points are uniform in the volume. A point x lies on the isosurface c = h(x), so they
// sample all isosurfaces in the texel at once (thesis 4.5). Skips points outside the isovalue
// range, in masked cells, without a gradient, or inside an isosurface of another volume. If the
// texel's box has too few points, searches the neighborhood that trilinear lookups can reach. If
// that has none, moves its points to the isosurface in the middle of the isovalue range. Returns
// the number of visited points.
template <int D, class Visit>
int for_each_texel_sample(const SceneTracer<D>& tracer, int volume, bool back,
                          const TexelLattice<D>& lattice, std::uint32_t texel, int samples,
                          std::uint64_t key, Visit visit) {
  constexpr int tries_per_sample = 16;
  // Interpolated lookups blur once more, so a texel averages over less than its own box. Values of
  // 0.25 to 0.5 give equal errors on smooth surfaces; less is better on thin shells
  // (docs/decisions/thesis.md).
  constexpr double own_half_width = 0.35;
  const Volume<D>& scene_volume = tracer.scene().volumes[volume];
  const Field<D>& field = scene_volume.field;
  const IsovalueRange& isovalue_range = tracer.scene().isovalue_range;
  int visited = 0;
  const auto try_point = [&](const Vec<D>& position) {
    const CellPoint<D> point = locate(field, position);
    const double h = interpolate(load_corners(field, point.cell), point.local);
    const double c = scene_volume.common_isovalue(h);
    if (!isovalue_range.contains(c)) return;
    const SurfacePoint<D> surface = tracer.isosurface_point(volume, point, c, back);
    if (surface.kind() == HitKind::none) return;
    if (tracer.is_covered(volume, surface.position, c)) return;
    visit(surface, visited++);
  };
  for (const double half_width : {own_half_width, 1.0}) {
    const TexelBox<D> box(lattice, texel, half_width);
    for (int i = 0; i < tries_per_sample * samples && visited < samples; ++i) {
      try_point(box.point(i, key));
    }
  }
  if (visited > 0) return visited;
  const TexelBox<D> box(lattice, texel, 1);
  const double middle = scene_volume.isovalue(0.5 * (isovalue_range.min + isovalue_range.max));
  for (int i = 0; i < samples; ++i) {
    const Vec<D> position = moved_to_isosurface(field, box.point(i, key), middle);
    if (box.contains(position)) try_point(position);
  }
  return visited;
}

}  // namespace leaflight

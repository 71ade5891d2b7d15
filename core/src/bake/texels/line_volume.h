// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>

#include "bake/texels/texel_moments.h"
#include "trace/line_bundle.h"
#include "trace/scene_tracer.h"

namespace leaflight {

// A volume for line passes.
template <int D>
struct LineVolume {
  const SceneTracer<D>& tracer;
  int number;
  const EmptySpace<D>& empty;  // below the isovalue range

  const Volume<D>& volume() const { return tracer.scene().volumes[number]; }
  IsovalueRange isovalue_range() const { return volume().isovalues(tracer.scene().isovalue_range); }
};

// Returns the number of the texel nearest to a position in texels.
template <int D>
std::size_t nearest_texel(const TexelLattice<D>& lattice, const Vec<D>& position) {
  return lattice.linear(lattice.nearest_texel(position));
}

// A lattice with the slot of every texel, for fast lookups.
template <int D>
struct IndexedLattice {
  TexelLattice<D> lattice;
  std::vector<std::int32_t> slots;  // one per texel

  IndexedLattice() = default;
  explicit IndexedLattice(TexelLattice<D> from)
      : lattice(std::move(from)), slots(lattice.texels(), TexelLattice<D>::inactive) {
    for (std::size_t s = 0; s < lattice.active_texels; ++s) {
      slots[lattice.active[s]] = static_cast<std::int32_t>(s);
    }
  }
};

template <int D>
Affine<D> texels_to_frame(const LineVolume<D>& volume, const TexelLattice<D>& lattice) {
  Affine<D> m = volume.tracer.index_to_frame(volume.number);
  for (int a = 0; a < D; ++a) m.column[a] *= lattice.voxels_per_texel[a];
  return m;
}

// True if a facet of the walls may lie in the convex hull of a volume and, if given, a point of the
// frame. Two tests find most that do not: boxes, and the facet's plane. Walls of a turned room, for
// example, have wide boxes.
template <int D>
bool meshes_near(const SceneTracer<D>& tracer, int volume, const Vec<D>* point);

// Calls body(local, bundle, number) for bundles of all lines of a set, in parallel. Each piece of
// the work calls local() once and reuses its result. Numbers of bundles are `width` apart. Only one
// of several lines through a texel serves it, so there are no write conflicts.
template <int D, class Local, class Body>
void for_each_bundle(const LineVolume<D>& volume, const TexelLattice<D>& lattice,
                     const LineSet<D>& set, const Planes<D>& planes, Progress& progress,
                     Local local, Body body) {
  constexpr std::size_t width = LineBundle<D>::width;
  const std::size_t row = (set.tracks[0].size() + width - 1) / width;
  const std::size_t rows = D == 3 ? set.tracks[D - 2].size() : 1;
  parallel_range(row * rows, std::clamp<std::size_t>(row, 1, 32), 0, progress,
                 [&](std::size_t begin, std::size_t end) {
                   LineBundle<D> bundle(volume.volume().field, volume.empty, lattice, set, planes);
                   auto scratch = local();
                   for (std::size_t i = begin; i < end && !progress.cancelled(); ++i) {
                     typename LineBundle<D>::Tracks tracks;
                     tracks[0] = static_cast<int>(i % row * width);
                     if constexpr (D == 3) tracks[1] = static_cast<int>(i / row);
                     bundle.follow(tracks);
                     body(scratch, bundle, i * width);
                   }
                 });
}

}  // namespace leaflight

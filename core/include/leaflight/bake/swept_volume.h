// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>

#include "leaflight/bake/leaf_shadows.h"
#include "leaflight/bake/texel_moments.h"
#include "leaflight/trace/line_values.h"
#include "leaflight/trace/scene_tracer.h"

namespace leaflight {

// A volume that lines are swept through.
template <int D>
struct SweptVolume {
  const SceneTracer<D>& tracer;
  int number;
  const std::vector<Vec<D, float>>& gradients;  // of c, at the voxels, in the frame

  const Volume<D>& volume() const { return tracer.scene().volumes[number]; }
  IsovalueWindow window() const { return volume().isovalues(tracer.scene().window); }
};

// A lattice whose slots can be looked up once a sample.
template <int D>
struct SweptLattice {
  TexelLattice<D> lattice;
  std::vector<std::int32_t> slots;  // of all texels

  SweptLattice() = default;
  explicit SweptLattice(TexelLattice<D> from)
      : lattice(std::move(from)), slots(lattice.texels(), TexelLattice<D>::inactive) {
    for (std::size_t s = 0; s < lattice.active.size(); ++s) {
      slots[lattice.active[s]] = static_cast<std::int32_t>(s);
    }
  }
  // Of the texel nearest to a position in texels.
  std::int32_t slot_near(const Vec<D>& position) const {
    return slots[nearest_texel(lattice, position)];
  }
};

template <int D>
Affine<D> texels_to_frame(const SweptVolume<D>& volume, const TexelLattice<D>& lattice) {
  Affine<D> m = volume.tracer.index_to_frame(volume.number);
  for (int a = 0; a < D; ++a) m.column[a] *= lattice.voxels_per_texel[a];
  return m;
}

// Whether a facet of the surroundings may lie in the box about the field and, if given, a point.
template <int D>
bool meshes_near(const SweptVolume<D>& volume, const Vec<D>* point);

// Calls body(local, tracks) for each line of a set, in parallel, with what local() made for some of
// them. Lines that come to the same texel leave it to one of them, so that no two write to one
// place.
template <int D, class Local, class Body>
void for_each_line(const LineSet<D>& set, Progress& progress, Local local, Body body) {
  const std::size_t row = set.tracks[0].size();
  parallel_range(set.lines(), std::clamp<std::size_t>(row, 1, 256), 0, progress,
                 [&](std::size_t begin, std::size_t end) {
                   auto own = local();
                   for (std::size_t i = begin; i < end && !progress.cancelled(); ++i) {
                     std::array<int, static_cast<std::size_t>(D - 1)> tracks;
                     tracks[0] = static_cast<int>(i % row);
                     if constexpr (D == 3) tracks[1] = static_cast<int>(i / row);
                     body(own, tracks);
                   }
                 });
}

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "bake/direct/visibility_sweep.h"

namespace leaflight {

// How the isosurfaces of another volume stand in the way of light to those of one: of the same
// common isovalue, which both volumes' codes stand for. Nodes of the other volume are swept,
// and looked up where the way from a node of this one to the light enters the other volume.
template <int D>
class VisibilityThrough {
 public:
  // `nodes`: texels of `volume`, of which the active ones count; `code_range`: of common isovalues.
  // All else that is given must outlive it.
  VisibilityThrough(const SceneTracer<D>& tracer, int other, int volume,
                    const TexelLattice<D>& nodes, const IsovalueRange& code_range);

  // Raises the codes of the nodes to the greatest of the other volume on their way to a point of
  // light, the node itself included.
  void run(const LightSource<D>& source, std::vector<std::uint8_t>& found,
           Progress& progress) const;

 private:
  const Field<D>& field_;  // of the other volume
  VisibilityCode code_;
  const TexelLattice<D>& nodes_;
  TexelLattice<D> lattice_;  // of the other volume's voxels
  VisibilitySweep<D> sweep_;
  Affine<D> to_frame_, to_other_;  // from the indices of the nodes' volume; from the frame
};

// The greatest codes of all volumes of a scene on the ways from a point of light to nodes of one.
template <int D>
class VisibilityThroughAll {
 public:
  // As VisibilityThrough and VisibilitySweep have it.
  VisibilityThroughAll(const SceneTracer<D>& tracer, int volume, const TexelLattice<D>& nodes,
                       const IsovalueRange& code_range, double spacing);

  // Into as many codes as there are nodes.
  void run(const LightSource<D>& source, const VisibilityCode& code,
           std::vector<std::uint8_t>& found, Progress& progress) const;

 private:
  VisibilitySweep<D> own_;
  std::vector<std::unique_ptr<VisibilityThrough<D>>> others_;
};

}  // namespace leaflight

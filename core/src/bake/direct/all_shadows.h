// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "bake/direct/visibility_sweep.h"

namespace leaflight {

// The shadows that isosurfaces of another volume cast on those of one volume, for equal common
// isovalues. The sweep runs over nodes of the other volume. Each node of this volume looks up the
// code where the segment to the light enters the other volume.
template <int D>
class OtherVolumeShadows {
 public:
  // `nodes`: texels of `volume`; only active ones are computed. `code_range`: in common isovalues.
  // The other inputs must outlive it.
  OtherVolumeShadows(const SceneTracer<D>& tracer, int other, int volume,
                     const TexelLattice<D>& nodes, const IsovalueRange& code_range);

  // Raises the code of each node to the greatest code of the other volume between it and a light
  // point.
  void run(const LightSource<D>& source, std::vector<std::uint8_t>& found,
           Progress& progress) const;

 private:
  const Field<D>& field_;  // of the other volume
  VisibilityCode code_;
  const TexelLattice<D>& nodes_;
  TexelLattice<D> lattice_;  // one texel per voxel of the other volume
  VisibilitySweep<D> sweep_;
  Affine<D> to_frame_, to_other_;  // from the indices of `volume`; from the frame
};

// The shadows that isosurfaces of all volumes cast on those of one volume: for each node, the
// greatest code between it and a light point.
template <int D>
class AllShadows {
 public:
  // The parameters are those of OtherVolumeShadows and VisibilitySweep.
  AllShadows(const SceneTracer<D>& tracer, int volume, const TexelLattice<D>& nodes,
             const IsovalueRange& code_range, double spacing);

  // Computes one code per node.
  void run(const LightSource<D>& source, const VisibilityCode& code,
           std::vector<std::uint8_t>& found, Progress& progress) const;

 private:
  VisibilitySweep<D> own_;
  std::vector<std::unique_ptr<OtherVolumeShadows<D>>> others_;
};

}  // namespace leaflight

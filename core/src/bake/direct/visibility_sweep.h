// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/large_array.h"
#include "base/progress.h"
#include "field/texel_lattice.h"
#include "lights/light_sample.h"
#include "trace/scene_tracer.h"

namespace leaflight {

// Values of a field as bytes, for shadow comparisons. Codes 1 to 253 cover a range; 0 is below it,
// and 254 is above it. Code 255 is behind a mesh, where nothing is lit. For backs, the order of the
// values is reversed.
struct VisibilityCode {
  IsovalueRange range;
  bool back = false;

  float operator()(double h) const {
    return static_cast<float>(1 + (back ? range.max - h : h - range.min) * scale());
  }
  double scale() const { return 252 / range.height(); }
  static constexpr float most = 254;
  static constexpr std::uint8_t dark = 255;
};

// Sweeps through one volume from light points. The nodes are all texels of a lattice. For each node
// it finds the greatest code on the way to the light point, starting one texel away from the node.
// An isosurface of a greater value is lit there. Nothing is lit behind walls. The sweep visits
// planes of the field in the order of the light. Lines from the light carry the greatest value so
// far and are interpolated at the nodes. Lines are less than a voxel apart: their number doubles
// where they diverge. A line costs as much as one shadow ray and serves all nodes next to it.
template <int D>
class VisibilitySweep {
 public:
  // `meshes`: true if walls block light. `spacing`: upper bound on the voxels between lines and
  // between planes, unless nodes are closer together; above 1, sweeps may miss thin features. The
  // inputs must outlive the sweep.
  VisibilitySweep(const SceneTracer<D>& tracer, int volume, const TexelLattice<D>& nodes,
                  bool meshes = true, double spacing = 1);

  // Computes one code per node for a light point.
  void run(const LightSource<D>& source, const VisibilityCode& code,
           std::vector<std::uint8_t>& found, Progress& progress) const;

 private:
  const SceneTracer<D>& tracer_;
  int volume_;
  const TexelLattice<D>& nodes_;
  bool meshes_;
  double spacing_;
  // The field's values with axis 0 slowest, so that its planes are contiguous.
  std::variant<LargeArray<float>, LargeArray<std::uint8_t>, LargeArray<std::int16_t>,
               LargeArray<std::uint16_t>>
      turned_;
};

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "field/texel_lattice.h"
#include "math/large_array.h"
#include "math/progress.h"
#include "trace/scene_tracer.h"
#include "transport/lamp_sampling.h"

namespace leaflight {

// Values of a field as bytes, to compare for shadows: 1 to 253 over a range, 0 below it, 254 above
// it, 255 behind a mesh, where nothing is lit. For backs the order of the values is turned around.
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

// Sweeps through one volume from points of light. For each of the nodes, all texels of a lattice,
// it finds the greatest code on its way to the point, from one texel away from the node on: an
// isosurface of a greater value is lit there. Beyond the walls nothing is.
//
// Planes of the field are taken in the order in which the light passes them. Lines from the light
// carry the greatest value so far; they are less than a voxel apart, since twice as many take over
// where they are not, and are interpolated at the nodes. A line so costs as much as one shadow ray
// and serves all nodes beside it.
template <int D>
class VisibilitySweep {
 public:
  // `meshes`: whether the walls end the way. `spacing`: voxels between lines and between planes at
  // most, where nodes are not nearer to each other; above 1 they may miss what is thinner. All that
  // is given must outlive it.
  VisibilitySweep(const SceneTracer<D>& tracer, int volume, const TexelLattice<D>& nodes,
                  bool meshes = true, double spacing = 1);

  // From a point of light, into as many codes as there are nodes.
  void run(const LightSource<D>& source, const VisibilityCode& code,
           std::vector<std::uint8_t>& found, Progress& progress) const;

 private:
  const SceneTracer<D>& tracer_;
  int volume_;
  const TexelLattice<D>& nodes_;
  bool meshes_;
  double spacing_;
  // The field's values, axis 0 slowest, so that its planes lie together.
  std::variant<LargeArray<float>, LargeArray<std::uint8_t>, LargeArray<std::int16_t>,
               LargeArray<std::uint16_t>>
      turned_;
};

}  // namespace leaflight

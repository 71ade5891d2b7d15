// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "trace/scene_tracer.h"

namespace leaflight {

// How much of the indirect light of isosurfaces, by channel, comes from which lamps of a
// scene: what reaches isosurfaces of any isovalue after one reflection. All in one unit.
struct IndirectShares {
  std::vector<Imath::V3d> lights;  // of each of the scene's lights
  // Of the environment, emissive meshes and isosurfaces; what has no light points counts before its
  // first reflection, too.
  Imath::V3d others{0.0};

  // How much more there is, by channel, with the lights brighter by factors: the mean of these
  // where nothing comes back.
  Rgb factor(const std::vector<Rgb>& factors) const;
  // Of all of them.
  Imath::V3d total() const;
};

// Estimated by a fixed number of paths a lamp.
template <int D>
IndirectShares indirect_shares(const SceneTracer<D>& tracer);

}  // namespace leaflight

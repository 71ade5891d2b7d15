// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "trace/scene_tracer.h"

namespace leaflight {

// The parts of the indirect light of isosurfaces that the lamps of a scene cause, by channel. It
// counts light that reaches isosurfaces of any isovalue after one reflection. All parts have the
// same unit.
struct IndirectShares {
  std::vector<Imath::V3d> lights;  // one per light of the scene
  // Light of the environment, emissive meshes and isosurfaces. Light without light points also
  // counts before its first reflection.
  Imath::V3d others{0.0};

  // Returns the ratio by which indirect light grows, by channel, if each light is scaled by a
  // factor. Returns the mean factor if there is no indirect light.
  Rgb factor(const std::vector<Rgb>& factors) const;
  // Returns the sum of all parts.
  Imath::V3d total() const;
};

// Estimates the shares with a fixed number of paths per lamp.
template <int D>
IndirectShares indirect_shares(const SceneTracer<D>& tracer);

}  // namespace leaflight

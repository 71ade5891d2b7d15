// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "bake/plan/settings.h"
#include "math/error.h"
#include "scene/scene.h"

namespace leaflight {

struct SkippedPass {
  std::string pass;
  std::string reason;
};

// Which passes a bake needs. Each pass that is left out is listed with its reason.
struct Plan {
  bool lines = false;      // lines through the one volume light it; otherwise paths
  bool indirect = true;    // indirect light that has bounced before it reaches the texel
  bool specular = true;    // rays go on after mirrors and glass
  bool caustics = true;    // photons that come by mirrors and glass
  bool photons = true;     // photon tracing into the caches
  bool wall_cache = true;  // radiance of the walls over (u, v, c), for gather rays
  bool back_side = true;   // photons on the inside of isosurfaces
  bool back = true;        // the back's radiance is stored
  bool walls = true;       // the radiance of the walls is stored
  std::vector<SkippedPass> skipped;
};

// A way to find indirect light, as far as the passes depend on it.
struct IndirectMethod {
  std::string name;
  bool photons;   // they must be traced
  bool walls;     // the radiance of the walls is looked up
  bool caustics;  // are part of its light
};

template <int D>
Plan make_plan(const Scene<D>& scene, const BakeSettings<D>& settings);
template <int D>
Plan make_plan(const Scene<D>& scene, const IndirectMethod& method, bool both_sides, bool walls);

// Why a scene without texels and lit meshes has nothing to bake.
template <int D>
Error nothing_to_bake(const Scene<D>& scene);

}  // namespace leaflight

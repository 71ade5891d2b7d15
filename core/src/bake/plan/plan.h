// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "bake/plan/settings.h"
#include "base/error.h"
#include "scene/scene.h"

namespace leaflight {

struct SkippedPass {
  std::string pass;
  std::string reason;
};

// The passes that a bake needs. Each skipped pass is listed with its reason.
struct Plan {
  bool lines = false;      // true if lines light the only volume; otherwise paths light all
  bool indirect = true;    // light that has bounced before it reaches the texel
  bool specular = true;    // rays continue after mirrors and glass
  bool caustics = true;    // photons through mirrors and glass
  bool photons = true;     // photon tracing into the caches
  bool wall_cache = true;  // radiance of the walls over (u, v, c), for gather rays
  bool back_side = true;   // photons on the inside of isosurfaces
  bool back = true;        // the back's radiance
  bool walls = true;       // the radiance of the walls
  std::vector<SkippedPass> skipped;
};

// Properties of a method of indirect light that the passes depend on.
struct IndirectMethod {
  std::string name;
  bool photons;   // true if it needs photons
  bool walls;     // true if it looks up the radiance of the walls
  bool caustics;  // true if its light includes caustics
};

template <int D>
Plan make_plan(const Scene<D>& scene, const BakeSettings<D>& settings);
template <int D>
Plan make_plan(const Scene<D>& scene, const IndirectMethod& method, bool both_sides, bool walls);

// Returns the error of a scene without texels and lit meshes, with its reason.
template <int D>
Error nothing_to_bake(const Scene<D>& scene);

}  // namespace leaflight

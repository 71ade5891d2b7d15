// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/bake/radiance_grid.h"
#include "leaflight/bake/settled_direct.h"
#include "leaflight/bake/settled_indirect.h"
#include "leaflight/surface/marching_cubes.h"

namespace leaflight {

struct SettleSettings {
  int volume = 0;           // whose leaf it is
  double c = 0;             // the leaf coordinate
  bool above = false;       // the inner side
  double tolerance = 2e-3;  // the standard error of direct radiance at which a vertex is left alone
  std::uint64_t seed = 0;
};

// The light of one leaf where the isovalue rests, at the vertices of its mesh. A bake's texels
// average the light of all leaves through them, within thin shells that of both faces. Here direct
// light is traced at the vertices, and indirect light corrected by paths that start there.
//
// Paths miss the caustics of lights without extent, and meet others rarely: where mirrors or glass
// are in the scene indirect light remains that of the bake.
class Settle {
 public:
  // `scene` and `grid` must outlive this. The mesh's normals point outward on either side. Throws
  // Error where the leaf is a mirror or glass, and for an inner side beside mirrors or glass, of
  // whose indirect light a bake keeps nothing.
  Settle(const Scene<3>& scene, const RadianceGrid<3>& grid, IsosurfaceMesh mesh,
         const SettleSettings& settings);

  int rounds() const { return static_cast<int>(rounds_.size()); }
  int rounds_done() const { return done_; }
  // One round more; does nothing after the last. Deterministic; one that was cancelled may be
  // called for again, and what it found is kept. Throws Cancelled.
  void refine(Progress& progress);

  // Radiance [W/(m^2 sr)] of the vertices, and the standard error, of its mean over the channels,
  // of what was traced here; a bake does not tell that of its indirect light alone.
  struct Settled {
    std::vector<Vec<3, float>> radiance;
    std::vector<float> error;
  };
  Settled settled() const;
  std::uint64_t rays() const { return rays_; }

 private:
  enum class Round { direct, indirect };

  SceneTracer<3> tracer_;
  LightSampler<3> lights_;
  RestingLeaf leaf_;
  SettledDirect direct_;
  SettledIndirect indirect_;
  std::vector<Round> rounds_;
  int done_ = 0;
  std::uint64_t rays_ = 0;
};

}  // namespace leaflight

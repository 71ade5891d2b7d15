// SPDX-License-Identifier: GPL-3.0-or-later
// Helpers for tests of bakes in passes: small bakes, and comparisons of two bakes.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "agreement.h"
#include "bake/driver/bake.h"
#include "bake/plan/settings.h"

namespace leaflight::test {

inline BakeSettings<3> in_passes(double error = 1.5) {
  BakeSettings<3> settings;
  settings.error = sanitized ? std::min(100.0, 20 * error) : error;
  if (sanitized) settings.resolution = {17, 17, 17};
  return settings;
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  if (a.size() != b.size()) return false;
  return a.empty() || std::memcmp(static_cast<const void*>(a.data()),
                                  static_cast<const void*>(b.data()), a.size() * sizeof(T)) == 0;
}

inline bool same_bits(const RadianceGrid<3>& a, const RadianceGrid<3>& b) {
  return a.lattice.active == b.lattice.active &&
         same_bits(a.radiance_indirect, b.radiance_indirect) &&
         same_bits(a.radiance_error, b.radiance_error) &&
         same_bits(a.radiance_back_indirect, b.radiance_back_indirect);
}

// Returns a bake with all light of its texels.
inline Baked<3> with_all_light(const Scene<3>& scene, Baked<3> baked) {
  RadianceGrid<3>& grid = baked.grids[0];
  grid.radiance = all_light(grid, field_of(scene), false);
  if (grid.has_back()) grid.radiance_back = all_light(grid, field_of(scene), true);
  return baked;
}

// Returns settings that bake both sides and the walls.
inline BakeSettings<3> all_light(int texels) {
  BakeSettings<3> settings = in_passes();
  settings.both_sides = true;
  settings.walls = !sanitized;
  settings.resolution = Index<3>{texels, texels, texels};
  return settings;
}

inline void expect_same_light(const std::vector<Baked<3>>& bakes) {
  for (const Baked<3>& other : bakes) {
    EXPECT_TRUE(same_bits(bakes[0].grids[0], other.grids[0]));
    ASSERT_EQ(bakes[0].walls.radiance.size(), other.walls.radiance.size());
    for (std::size_t m = 0; m < other.walls.radiance.size(); ++m) {
      EXPECT_TRUE(same_bits(bakes[0].walls.radiance[m][0], other.walls.radiance[m][0]));
    }
  }
}

inline Scene<3> small_scene() { return cornell(ball<3>(17), {0.6, 0.9}); }

// Returns the light of a stopped bake, from which another bake continues.
inline std::vector<PreviousLight<3>> previous_light(const Baked<3>& baked) {
  const BakeStatistics& s = baked.statistics;
  std::vector<PreviousLight<3>> previous;
  for (const auto& grid : baked.grids) previous.emplace_back(grid, s.passes, s.blocks);
  return previous;
}

inline Baked<3> stopped_after(int passes, const Scene<3>& scene, const BakeSettings<3>& settings,
                              const std::vector<PreviousLight<3>>* previous = nullptr) {
  Progress progress;
  const auto look = [&](Baked<3>&&) {
    if (--passes == 0) progress.stop();
  };
  return bake<3>(scene, settings, progress, {look, previous});
}

// Returns a bake that continues another for a pass.
inline Baked<3> continued(const Baked<3>& baked, const Scene<3>& scene,
                          const BakeSettings<3>& settings) {
  const std::vector<PreviousLight<3>> previous = previous_light(baked);
  return stopped_after(1, scene, settings, &previous);
}

}  // namespace leaflight::test

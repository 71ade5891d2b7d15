// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "trace/scene_tracer.h"
#include "transport/environment_sampler.h"
#include "transport/mesh_emitter.h"

namespace leaflight {

// A point of a lamp that represents a part of it.
template <int D>
struct LightPoint {
  LightSource<D> source;  // frame
  // Number of its light in the scene; -1: an emissive mesh or the environment.
  int light = -1;
};

// A scene's light in two parts. Points represent lights whose shadows have edges: all lamps, small
// emissive meshes, and bright parts of an environment image. The rest covers wide angles, and rays
// that hit it sample it.
template <int D>
struct SplitLight {
  std::vector<LightPoint<D>> points;
  std::vector<char> mesh_is_wide;      // one per mesh: true if it emits and has no points
  std::optional<Environment<D>> wide;  // null: no light from it
};

// Splits the light. The points depend on positions of the lights, not on random numbers, nor on
// their strengths, except that black lights have no points. Lights and emissive meshes get 16 to 64
// points, by their size as seen from the center of the volumes. Lights without extent get one.
template <int D>
SplitLight<D> split_light(const SceneTracer<D>& tracer);

// Returns sets of equally many points, the first that of split_light(). Their positions differ, so
// together they sample the light more finely.
inline constexpr int light_point_sets = 7;
template <int D>
std::vector<std::vector<LightPoint<D>>> interleaved_points(const SceneTracer<D>& tracer);

// Returns, for each point, the number of an earlier one with the same geometry, whatever its
// amount; -1: none.
template <int D>
std::vector<int> same_points(const std::vector<LightPoint<D>>& points,
                             const std::vector<LightPoint<D>>& earlier);

// Scales the points by a factor per channel of each light in the scene.
template <int D>
void scale_points(const std::vector<Rgb>& lights, std::vector<LightPoint<D>>& points);

}  // namespace leaflight

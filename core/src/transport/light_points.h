// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "transport/environment_sampler.h"
#include "transport/mesh_emitter.h"

namespace leaflight {

// A point of a lamp that stands for a part of it.
template <int D>
struct LightPoint {
  LightSource<D> source;  // frame
  // The number of the scene's light that it belongs to; -1: an emissive mesh or the environment.
  int light = -1;
};

// A scene's light in two parts. Points stand for what throws shadows with edges: all lights, the
// emissive meshes that are small in the sky, and what an image of the environment holds that is
// much brighter than its mean. The rest covers wide angles, and is sampled by the rays that hit it.
template <int D>
struct SplitLight {
  std::vector<LightPoint<D>> points;
  std::vector<char> mesh_is_wide;      // of each mesh: it emits, and has no points
  std::optional<Environment<D>> wide;  // null: nothing comes from it
};

// The points depend on where the lights are, and on nothing random; on how bright the lights are
// only where a light is black. Lights and emissive meshes get 16 to 64 points, by their size as
// seen from the middle of the volumes; those without extent get one.
template <int D>
SplitLight<D> split_light(const SceneTracer<D>& tracer);

// Sets of as many points, the first that of split_light(), all in other places: together they stand
// for the light more finely.
inline constexpr int light_point_sets = 7;
template <int D>
std::vector<std::vector<LightPoint<D>>> interleaved_points(const SceneTracer<D>& tracer);

// For each point the number of an earlier one whose light goes the same ways, whatever its amount;
// -1 where there is none.
template <int D>
std::vector<int> same_points(const std::vector<LightPoint<D>>& points,
                             const std::vector<LightPoint<D>>& earlier);

// Makes the points of the scene's lights brighter by a factor per channel of each light.
template <int D>
void scale_points(const std::vector<Rgb>& lights, std::vector<LightPoint<D>>& points);

}  // namespace leaflight

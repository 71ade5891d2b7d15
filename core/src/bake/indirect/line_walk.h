// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "trace/line_bundle.h"
#include "trace/scene_tracer.h"

namespace leaflight {

// Planes of a line whose values decrease, or increase, from bottom to top. A ray back along the
// line may first hit an isosurface at these planes.
struct Stack {
  struct Entry {
    float h;
    int plane;
  };
  std::vector<Entry> entries;
  int top = 0;

  // `bottom` is beyond all values and stays in the stack.
  Stack(std::size_t planes, float bottom) : entries(planes + 1) { entries[0] = {bottom, -1}; }
  void clear() { top = 0; }
  void push(float h, int plane) { entries[++top] = {h, plane}; }
};

// A point of a line at which the isosurface of value h gathers.
struct LineSample {
  double z;
  float h, weight;
  bool front;         // side of the isosurface
  std::int32_t slot;  // of the texel
};

// The point of a line at z where a ray back hits the isosurface of value h.
struct LineHit {
  float h;
  double z;
  bool on_back;
};

// A sample whose ray hits the isosurface of value h.
struct HitSample {
  std::int32_t receiver;  // slot of the texel that gathers
  float weight, h;
  bool front, on_back;  // side of the receiver, and of the hit
  bool on_cap;          // true if the hit lies on the cap of a cut
  // The two texels near the hit that may send their light, their slots, and the chosen slot.
  std::array<std::uint32_t, 2> texels;
  std::array<std::int32_t, 2> slots;
  std::int32_t sender;
};

// Working memory for the lines of a bundle at the planes that they cross.
template <int D>
struct GatherLines {
  // Slots of the points, or inactive.
  std::vector<std::array<std::int32_t, LineBundle<D>::width>> slots;
  std::size_t source = 0;  // number of a source of direct light
  // Working memory for one line at a time.
  std::vector<float> h;
  Stack higher, lower;
  std::vector<HitSample> hits;

  explicit GatherLines(std::size_t planes)
      : slots(planes),
        h(planes),
        higher(planes, std::numeric_limits<float>::infinity()),
        lower(planes, -std::numeric_limits<float>::infinity()) {
    hits.reserve(planes);
  }
};

// A walk along a line from one end to the other. Rays from its points lead back to its start.
template <int D>
struct Walk {
  int lane, step, begin, end;  // planes
  double length;               // length of the line between two planes
  Vec<D> to_origin;
  Rgb sky;
  int stretch;  // plane after the last masked one
  std::optional<MeshHit> wall;
  double wall_z, next_wall_z;  // z of the nearest mesh behind, and of the next one ahead
};

}  // namespace leaflight

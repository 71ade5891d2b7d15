// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

namespace leaflight {

enum class PartKind : std::int32_t {
  maps,     // visibility maps of light points
  paths,    // paths that measure the error, at some points
  shadows,  // shadow rays from vertices of a wall
  photons,  // photons, and the light of the walls from them
  bounces,  // the first bounces of indirect light
  block,    // a block of indirect light
  walls     // indirect light at vertices and nodes of a wall
};

// A part of a bake. Random numbers follow from it alone, so its result does not depend on who
// computes it. Its items are [begin, end), of a side or of a mesh where the kind has several.
struct BakePart {
  PartKind kind = PartKind::maps;
  std::int32_t back = 0, number = 0, mesh = 0;
  std::int32_t stride = 1;  // of a wall's vertices
  std::uint64_t begin = 0, end = 0;
};

// Adds parts with at most `at_once` of `count` items each; they are alike otherwise.
inline void add_parts(std::vector<BakePart>& parts, BakePart alike, std::size_t count,
                      std::size_t at_once) {
  for (alike.begin = 0; alike.begin < count; alike.begin = alike.end) {
    alike.end = std::min<std::uint64_t>(count, alike.begin + at_once);
    parts.push_back(alike);
  }
}

// Data that parts look up.
enum class PartData : std::uint8_t { maps, points, photons, lines };

// Processes that compute parts of a bake, on this machine or on others (part_tracer.h).
struct Workers {
  using Write = std::function<void(std::ostream&)>;

  // Sends data to all workers. It replaces earlier data of its kind for the parts announced later.
  std::function<void(PartData kind, const Write&)> send;
  // Announces parts; returns the number of the first, from which take() counts on.
  std::function<int(const std::vector<BakePart>&)> announce;
  // Waits for the result of a part. An empty string makes the bake compute it itself.
  std::function<std::string(int number)> take;
  // Forgets parts that nobody takes. Must not throw.
  std::function<void(int first, int count)> drop;
};

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <ostream>
#include <string>

#include "bake/texels/texel_moments.h"

namespace leaflight {

// Whoever traces blocks of indirect light for a bake, in other processes or on other machines
// (block_tracer.h). Blocks have numbers, from which all that is random in them follows, so that it
// makes no difference who traces them.
struct BlockWorkers {
  // Blocks [first, first + count) will be asked for. `looked_up` writes what their lines look up.
  std::function<void(int first, int count, const std::function<void(std::ostream&)>& looked_up)>
      begin;
  // What a tracer returned for one of them; empty: nobody has it, and the bake traces it itself.
  std::function<std::string(int number)> take;
};

// The sums of the open block of all texels, and how many lines they took, as bytes.
std::string block_bytes(const SideMoments& moments, std::uint64_t lines);

// Those of a tracer into the open block; returns the lines. Throws Error unless they are of as
// many texels and sides.
std::uint64_t take_block(const std::string& bytes, SideMoments& moments);

}  // namespace leaflight

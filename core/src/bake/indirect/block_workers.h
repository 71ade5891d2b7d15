// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <ostream>
#include <string>

#include "bake/texels/texel_moments.h"

namespace leaflight {

// Workers that trace blocks of indirect light for a bake, in other processes or on other machines
// (block_tracer.h). The number of a block determines its random numbers, so its result does not
// depend on the worker.
struct BlockWorkers {
  // Announces blocks [first, first + count). `looked_up` writes the data that their lines look up.
  std::function<void(int first, int count, const std::function<void(std::ostream&)>& looked_up)>
      begin;
  // Returns a worker's result for one block. An empty string makes the bake trace it itself.
  std::function<std::string(int number)> take;
};

// Returns the sums of the open block of all texels, and the number of its lines, as bytes.
std::string block_bytes(const SideMoments& moments, std::uint64_t lines);

// Reads block_bytes() into the open block and returns the number of lines. Throws Error if the
// numbers of texels or sides differ.
std::uint64_t take_block(const std::string& bytes, SideMoments& moments);

}  // namespace leaflight

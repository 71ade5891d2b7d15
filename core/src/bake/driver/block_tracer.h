// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "bake/driver/bake.h"
#include "bake/plan/settings.h"

namespace leaflight {

// Traces single blocks of indirect light for a bake in passes that runs elsewhere, of the same
// scene and settings. The bits are those of the bake itself.
class BlockTracer {
 public:
  // Scene and progress are referred to; progress.cancel() ends whatever is done with Cancelled.
  // Throws Error where such a bake has no passes.
  BlockTracer(const Scene<3>& scene, const BakeSettings<3>& settings, Progress& progress);
  ~BlockTracer();

  // Takes what BlockWorkers::begin() has written; blocks need it.
  void look_up(std::istream& stream);
  // A block, as block_bytes().
  std::string trace(int number);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

// About how many bytes it holds at most, the values of the volume included.
std::uint64_t block_tracer_memory(const Scene<3>& scene, const BakeSettings<3>& settings);

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "bake/driver/bake.h"
#include "bake/plan/settings.h"

namespace leaflight {

// Traces single blocks of indirect light for a bake in passes that runs in another process. Scene
// and settings must be equal; so the bits are those of the bake itself.
class BlockTracer {
 public:
  // Keeps references to scene and progress. progress.cancel() makes every call throw Cancelled.
  // Throws Error if a bake of these settings has no passes.
  BlockTracer(const Scene<3>& scene, const BakeSettings<3>& settings, Progress& progress);
  ~BlockTracer();

  // Reads the light that lines look up, as BlockWorkers::begin() provides it. Blocks need it.
  void look_up(std::istream& stream);
  // Traces a block and returns it as block_bytes() does.
  std::string trace(int number);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

// Estimates the maximum memory of a BlockTracer in bytes, including the values of the volume.
std::uint64_t block_tracer_memory(const Scene<3>& scene, const BakeSettings<3>& settings);

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <istream>
#include <memory>

#include "bake/driver/bake.h"
#include "bake/plan/settings.h"

namespace leaflight {

// Computes parts of a bake in passes that runs in another process. Scene and settings must be
// equal; so the bits are those of the bake itself.
class PartTracer {
 public:
  // Keeps references to scene and progress. progress.cancel() makes traced() throw Cancelled.
  // Throws Error if a bake of these settings has no passes by lines.
  PartTracer(const Scene<3>& scene, const BakeSettings<3>& settings, Progress& progress);
  ~PartTracer();

  // Reads what parts look up, as Workers::send() provides it.
  void read(PartData kind, std::istream& stream);
  // Computes a part, and returns what Workers::take() does.
  std::string traced(const BakePart& part);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Estimates the maximum memory of a PartTracer in bytes, including the values of the volume.
std::uint64_t part_tracer_memory(const Scene<3>& scene, const BakeSettings<3>& settings);

}  // namespace leaflight

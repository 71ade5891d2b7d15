// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "bake/direct/direct_light.h"
#include "bake/plan/shared_parts.h"

namespace leaflight {

// Computes parts of the visibility maps of a scene's only volume. The inputs must outlive it.
template <int D>
class MapParts {
 public:
  MapParts(const SceneTracer<D>& tracer, const std::vector<LightPoint<D>>& points,
           const MapSettings<D>& settings)
      : tracer_(tracer), points_(points), settings_(settings) {}

  std::vector<BakePart> parts() const;
  // Computes a part, as compressed bytes. The first call prepares the sweeps.
  std::string traced(const BakePart& part, Progress& progress);
  // Makes the light from the bytes of all parts(). Throws Error for those of another bake.
  std::shared_ptr<const DirectLight<D>> light(const std::vector<std::string>& parts) const;
  // Transfers the settings and the bytes of all parts, or none.
  static void write(std::ostream& stream, MapSettings<D> settings,
                    const std::vector<std::string>& parts);
  static std::pair<MapSettings<D>, std::vector<std::string>> read(std::istream& stream);

 private:
  const SceneTracer<D>& tracer_;
  const std::vector<LightPoint<D>>& points_;
  MapSettings<D> settings_;
  std::unique_ptr<const TexelLattice<D>> lattice_;
  std::optional<MapSweeps<D>> sweeps_;
};

}  // namespace leaflight

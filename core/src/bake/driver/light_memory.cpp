// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/light_memory.h"

#include <algorithm>
#include <cmath>

#include "bake/direct/direct_light.h"
#include "bake/driver/pass_texels.h"
#include "bake/plan/plan.h"
#include "base/error.h"

namespace leaflight {
namespace {

// Measured memory in bytes (docs/clusters.md), when it peaks: per texel that both the result and
// indirect light have, and per texel that one of them has in addition. While a file is written,
// memory per texel is `saved_texel`, and per voxel of the volume `saved_voxel`.
struct TexelBytes {
  double common, direct, indirect;
};
constexpr TexelBytes front_side{250, 40, 100}, both_sides{425, 55, 160}, walls{60, 30, 30};
constexpr double saved_texel = 100, saved_voxel = 0.27, photon_texel = 90, fixed = 16 << 20;
// The search over resolutions ends when this factor separates a fitting one from a failing one.
constexpr double step = 1.05;
constexpr int coarsest = 8;

class LightMemory {
 public:
  LightMemory(const Scene<3>& scene, const BakeSettings<3>& settings)
      : field_(scene.volumes[0].field),
        isovalue_range_(scene.volumes[0].isovalues(scene.isovalue_range)),
        settings_(settings) {
    const Plan plan = make_plan(scene, settings);
    points_ = split_light(SceneTracer<3>(scene)).points.size();
    sides_ = plan.back ? 2 : 1;
    a_texel_ = plan.back ? both_sides : front_side;
    if (plan.walls) {
      a_texel_.common += walls.common;
      a_texel_.direct += walls.direct;
      a_texel_.indirect += walls.indirect;
    }
    has_indirect_ = plan.indirect;
  }

  std::uint64_t bytes(const Index<3>& resolution) const {
    BakeSettings<3> settings = settings_;
    settings.resolution = resolution;
    const PassResolutions<3> chosen =
        pass_resolutions(field_, isovalue_range_, settings, Texels::fine);
    const double direct = texels(chosen.shown);
    const double indirect = has_indirect_ ? texels(chosen.indirect) : 0;
    const double common = std::min(direct, indirect);
    const double lighting = common * a_texel_.common + (direct - common) * a_texel_.direct +
                            (indirect - common) * a_texel_.indirect +
                            texels(chosen.photons) * photon_texel;
    const double maps =
        sides_ * static_cast<double>(map_bytes(field_, isovalue_range_, chosen.shown, points_));
    const double saved = direct * saved_texel + saved_voxel * static_cast<double>(field_.voxels());
    return static_cast<std::uint64_t>(fixed + maps + std::max(lighting, saved));
  }

  // Returns the resolution of texels that are `width` voxels wide.
  Index<3> resolution(double width) const {
    Index<3> coarser;
    for (int a = 0; a < 3; ++a) {
      coarser[a] = std::max(2, static_cast<int>(std::ceil((field_.dims[a] - 1) / width)) + 1);
    }
    return coarser;
  }

 private:
  double texels(const Index<3>& resolution) const {
    return static_cast<double>(
        active_texels(field_, resolution, isovalue_range_.min, isovalue_range_.max));
  }

  const Field<3>& field_;
  IsovalueRange isovalue_range_;
  const BakeSettings<3>& settings_;
  TexelBytes a_texel_;
  bool has_indirect_;
  std::size_t points_;
  double sides_;
};

}  // namespace

std::uint64_t light_memory(const Scene<3>& scene, const BakeSettings<3>& settings) {
  return LightMemory(scene, settings).bytes(settings.resolution);
}

Index<3> fitting_resolution(const Scene<3>& scene, const BakeSettings<3>& settings,
                            std::uint64_t bytes) {
  const LightMemory memory(scene, settings);
  std::uint64_t needed = memory.bytes({});
  if (needed <= bytes) return {};
  double width = 1;
  for (;;) {
    const double times = static_cast<double>(needed) / static_cast<double>(bytes);
    width *= std::max(step, 0.95 * std::cbrt(times));
    const Index<3> resolution = memory.resolution(width);
    needed = memory.bytes(resolution);
    if (needed <= bytes) return resolution;
    if (*std::max_element(resolution.begin(), resolution.end()) <= coarsest) {
      throw Error("The light of the volume does not fit into " + std::to_string(bytes >> 20) +
                  " MiB, however coarse; give more memory, or downsample the volume.");
    }
  }
}

}  // namespace leaflight

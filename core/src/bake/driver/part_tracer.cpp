// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/part_tracer.h"

#include <tbb/task_arena.h>

#include "bake/driver/line_bake.h"
#include "bake/driver/measured_error.h"
#include "bake/driver/pass_texels.h"
#include "base/error.h"

namespace leaflight {

struct PartTracer::State {
  BakeSettings<3> settings;
  Plan plan;
  LitScene<3> lit;
  tbb::task_arena arena;
  // Tracers for each kind of parts; null before the first.
  std::unique_ptr<MapParts<3>> maps;
  std::unique_ptr<MeasuredError<3>> paths;
  std::unique_ptr<ShadowRayParts<3>> shadow_rays;
  std::unique_ptr<LineBake<3>> bake;

  State(const Scene<3>& scene, const BakeSettings<3>& given, Progress& progress)
      : settings(given),
        plan(make_plan(scene, given)),
        lit(scene, settings, plan, progress),
        arena(given.threads > 0 ? given.threads : tbb::task_arena::automatic) {}

  LineBake<3>& line_bake() {
    if (!bake) {
      BakeTexels<3> texels = pass_texels(lit.volumes[0], settings);
      texels.photon_count = 0;  // photons are a part
      bake = std::make_unique<LineBake<3>>(lit, std::move(texels));
    }
    return *bake;
  }

  void read_maps(std::istream& stream) {
    const auto [of_volume, packed] = MapParts<3>::read(stream);
    maps = std::make_unique<MapParts<3>>(lit.tracer, lit.split.points, of_volume);
    if (packed.size() < maps->parts().size()) return;
    lit.direct[0] = maps->light(packed);
    maps.reset();
  }

  void read_points(std::istream& stream) {
    std::vector<AreaPoint<3>> points;
    Archive archive(stream);
    archive(points, MeasuredError<3>::most_points);
    paths = std::make_unique<MeasuredError<3>>(lit, points);
  }

  std::string traced(const BakePart& part) {
    switch (part.kind) {
      case PartKind::maps:
        return known(maps).traced(part, lit.progress);
      case PartKind::paths:
        return known(paths).traced(part);
      case PartKind::shadows:
        if (!shadow_rays) {
          shadow_rays = std::make_unique<ShadowRayParts<3>>(lit.tracer, lit.subdivided());
        }
        return shadow_rays->traced(part, lit.progress);
      default:
        if (!lit.direct[0]) throw lacks_data();
        return line_bake().traced(part);
    }
  }

  template <class Parts>
  static Parts& known(const std::unique_ptr<Parts>& parts) {
    if (!parts) throw lacks_data();
    return *parts;
  }
  static Error lacks_data() { return Error("A part of a bake needs data that was not sent."); }
};

PartTracer::PartTracer(const Scene<3>& scene, const BakeSettings<3>& settings, Progress& progress) {
  validate(scene);
  validate(settings);
  state_ = std::make_unique<State>(scene, settings, progress);
  if (!state_->plan.lines) {
    throw Error("Only bakes in passes by lines have parts that others can trace.");
  }
}

PartTracer::~PartTracer() = default;

void PartTracer::read(PartData kind, std::istream& stream) {
  state_->arena.execute([&] {
    switch (kind) {
      case PartData::maps:
        return state_->read_maps(stream);
      case PartData::points:
        return state_->read_points(stream);
      default:
        state_->shadow_rays.reset();  // the bake has announced them before
        return state_->line_bake().read(kind, stream);
    }
  });
}

std::string PartTracer::traced(const BakePart& part) {
  return state_->arena.execute([&] {
    const std::uint64_t before = state_->lit.progress.rays();
    std::string bytes = state_->traced(part);
    SharedParts::add_rays(bytes, state_->lit.progress.rays() - before);
    return bytes;
  });
}

std::uint64_t part_tracer_memory(const Scene<3>& scene, const BakeSettings<3>& settings) {
  validate(scene);
  validate(settings);
  const SceneTracer<3> tracer(scene);
  const EmptySpace<3> empty(scene.volumes[0].field,
                            scene.volumes[0].isovalues(scene.isovalue_range).min);
  const LineVolume<3> volume{tracer, 0, empty};
  const BakeTexels<3> texels = pass_texels(volume, settings);
  const Plan plan = make_plan(scene, settings);
  const std::uint64_t sides = plan.back ? 2 : 1;
  const auto known = [&](const IndexedLattice<3>& lattice) {
    return lattice.slots.size() * sizeof(lattice.slots[0]) +
           lattice.lattice.active.size() * sizeof(lattice.lattice.active[0]);
  };
  const Field<3>& field = volume.volume().field;
  std::uint64_t voxels = 1;
  for (const int nodes : field.dims) voxels *= static_cast<std::uint64_t>(nodes);
  const std::uint64_t bytes_a_voxel =
      std::visit([](const auto* values) { return sizeof(*values); }, field.values);
  const std::uint64_t indirect = texels.indirect.lattice.active.size();
  const std::uint64_t wall_entries =
      plan.wall_cache ? SurfaceCache<3>(tracer, false, 1, 0, true).entries() : 0;
  // Add up the values, the visibility maps, and the lookups of them and of the walls. Add indirect
  // light, as accumulated and as looked up, and one block, in memory and serialized.
  const std::uint64_t maps =
      sides * map_bytes(field, volume.isovalue_range(), texels.shown.lattice.resolution,
                        split_light(tracer).points.size());
  // Light of both sides for paths from walls.
  const std::uint64_t for_walls = plan.walls ? 2 * indirect * sizeof(Rgb) : 0;
  return voxels * bytes_a_voxel + maps + for_walls + wall_entries * sizeof(Rgb) +
         texels.indirect.lattice.active.size() * DirectLookup<3>::bytes_a_texel +
         known(texels.shown) + known(texels.indirect) +
         indirect * sides * TexelMoments::bytes_a_texel +
         3 * indirect * (2 * sides - 1) * sizeof(Rgb) + 2 * indirect * sides * sizeof(TexelSum);
}

}  // namespace leaflight

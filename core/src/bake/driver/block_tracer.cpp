// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/block_tracer.h"

#include <tbb/task_arena.h>

#include "bake/driver/line_bake.h"
#include "bake/driver/pass_texels.h"
#include "base/error.h"

namespace leaflight {

struct BlockTracer::Parts {
  BakeSettings<3> settings;
  Plan plan;
  LitScene<3> lit;
  tbb::task_arena arena;
  std::unique_ptr<LineBake<3>> bake;

  Parts(const Scene<3>& scene, const BakeSettings<3>& given, Progress& progress)
      : settings(given),
        plan(make_plan(scene, given)),
        lit(scene, settings, plan, progress),
        arena(given.threads > 0 ? given.threads : tbb::task_arena::automatic) {
    arena.execute([&] {
      BakeTexels<3> texels = pass_texels(lit.volumes[0], settings);
      texels.photon_count = 0;
      lit.compute_visibility_maps({texels.shown.lattice.resolution}, 1);
      bake = std::make_unique<LineBake<3>>(lit, std::move(texels));
    });
  }
};

BlockTracer::BlockTracer(const Scene<3>& scene, const BakeSettings<3>& settings,
                         Progress& progress) {
  validate(scene);
  validate(settings);
  parts_ = std::make_unique<Parts>(scene, settings, progress);
  if (!parts_->plan.lines) {
    throw Error("Only bakes in passes by lines have blocks that others can trace.");
  }
}

BlockTracer::~BlockTracer() = default;

std::uint64_t block_tracer_memory(const Scene<3>& scene, const BakeSettings<3>& settings) {
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
  return voxels * bytes_a_voxel + maps + wall_entries * sizeof(Rgb) +
         texels.indirect.lattice.active.size() * DirectLookup<3>::bytes_a_texel +
         known(texels.shown) + known(texels.indirect) +
         indirect * sides * TexelMoments::bytes_a_texel +
         3 * indirect * (2 * sides - 1) * sizeof(Rgb) + 2 * indirect * sides * sizeof(TexelSum);
}

void BlockTracer::look_up(std::istream& stream) {
  parts_->arena.execute([&] {
    Archive archive(stream);
    parts_->bake->serialize_lookups(archive);
  });
}

std::string BlockTracer::trace(int number) {
  return parts_->arena.execute([&] { return parts_->bake->traced_block(number); });
}

}  // namespace leaflight

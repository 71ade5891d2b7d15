// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/block_sweeper.h"

#include <tbb/task_arena.h>

#include "bake/driver/rounds.h"
#include "bake/driver/rounds_texels.h"
#include "bake/driver/swept_bake.h"
#include "math/error.h"

namespace leaflight {

struct BlockSweeper::Parts {
  BakeSettings<3> settings;
  Plan plan;
  LitScene<3> lit;
  tbb::task_arena arena;
  std::unique_ptr<SweptBake<3>> bake;

  Parts(const Scene<3>& scene, const BakeSettings<3>& of, Progress& progress)
      : settings(of),
        plan(make_plan(scene, of)),
        lit(scene, settings, plan, progress),
        arena(of.threads > 0 ? of.threads : tbb::task_arena::automatic) {
    arena.execute([&] {
      SweptTexels<3> texels = rounds_texels(lit.volumes[0], settings);
      texels.photon_count = 0;
      lit.learn_direct({texels.shown.lattice.resolution});
      bake = std::make_unique<SweptBake<3>>(lit, 0, std::move(texels));
    });
  }
};

BlockSweeper::BlockSweeper(const Scene<3>& scene, const BakeSettings<3>& settings,
                           Progress& progress) {
  validate(scene);
  validate(settings);
  parts_ = std::make_unique<Parts>(scene, settings, progress);
  if (!parts_->lit.takes_lines()) {
    throw Error("Only bakes in rounds by lines have blocks that others can sweep.");
  }
}

BlockSweeper::~BlockSweeper() = default;

std::uint64_t sweeper_memory(const Scene<3>& scene, const BakeSettings<3>& settings) {
  validate(scene);
  validate(settings);
  const SceneTracer<3> tracer(scene);
  const EmptySpace<3> empty(scene.volumes[0].field, scene.volumes[0].isovalues(scene.window).min);
  const SweptVolume<3> volume{tracer, 0, empty};
  const SweptTexels<3> texels = rounds_texels(volume, settings);
  const std::uint64_t sides = make_plan(scene, settings).back ? 2 : 1;
  const auto known = [&](const SweptLattice<3>& of) {
    return of.slots.size() * sizeof(of.slots[0]) +
           of.lattice.active.size() * sizeof(of.lattice.active[0]);
  };
  const Field<3>& field = volume.volume().field;
  std::uint64_t voxels = 1;
  for (const int nodes : field.dims) voxels *= static_cast<std::uint64_t>(nodes);
  const std::uint64_t bytes_a_voxel =
      std::visit([](const auto* values) { return sizeof(*values); }, field.values);
  const std::uint64_t soft = texels.soft.lattice.active.size();
  // The values, the maps of direct light and what lines look up of them, soft light as it comes and
  // as it is looked up, and a block as it is and as it goes.
  const std::uint64_t maps =
      sides * map_bytes(field, volume.window(), texels.shown.lattice.resolution,
                        split_light(tracer).points.size());
  return voxels * bytes_a_voxel + maps +
         texels.soft.lattice.texels() * LeafLight<3>::bytes_a_texel + known(texels.shown) +
         known(texels.soft) + soft * sides * TexelMoments::bytes_a_texel +
         3 * soft * (2 * sides - 1) * sizeof(Rgb) + 2 * soft * sides * sizeof(TexelSum);
}

void BlockSweeper::look_up(std::istream& stream) {
  parts_->arena.execute([&] {
    Keeper keeper(stream);
    parts_->bake->keep_looked_up(keeper);
  });
}

std::string BlockSweeper::sweep(int number) {
  return parts_->arena.execute([&] { return parts_->bake->sweep_for_others(number); });
}

}  // namespace leaflight

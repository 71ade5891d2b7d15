// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/block_sweeper.h"

#include <tbb/task_arena.h>

#include "leaflight/bake/rounds.h"
#include "leaflight/bake/rounds_texels.h"
#include "leaflight/math/error.h"

namespace leaflight {

struct BlockSweeper::Parts {
  BakeSettings<3> settings;
  Plan plan;
  SceneTracer<3> tracer;
  LightSampler<3> lights;
  EmptySpace<3> empty;
  SweptVolume<3> volume;
  std::atomic<std::uint64_t> rays{0};
  tbb::task_arena arena;
  std::unique_ptr<SweptBake<3>> bake;

  Parts(const Scene<3>& scene, const BakeSettings<3>& of, Progress& progress)
      : settings(of),
        plan(make_plan(scene, of)),
        tracer(scene),
        lights(tracer),
        empty(scene.volumes[0].field, scene.volumes[0].isovalues(scene.window).min),
        volume{tracer, 0, empty},
        arena(of.threads > 0 ? of.threads : tbb::task_arena::automatic) {
    arena.execute([&] {
      SweptTexels<3> texels = rounds_texels(volume, settings);
      texels.photon_count = 0;
      bake = std::make_unique<SweptBake<3>>(volume, lights, settings, plan, progress, rays,
                                            std::move(texels));
    });
  }
};

BlockSweeper::BlockSweeper(const Scene<3>& scene, const BakeSettings<3>& settings,
                           Progress& progress) {
  validate(scene);
  validate(settings);
  if (!fits_rounds(scene, settings, make_plan(scene, settings))) {
    throw Error("Only bakes in rounds have blocks that others can sweep.");
  }
  parts_ = std::make_unique<Parts>(scene, settings, progress);
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
  const auto swept = [&](const SweptLattice<3>& of) {
    const std::uint64_t active = of.lattice.active.size();
    return of.slots.size() * sizeof(of.slots[0]) + active * sizeof(of.lattice.active[0]) +
           active * sides * TexelMoments::bytes_a_texel;
  };
  const Field<3>& field = volume.volume().field;
  std::uint64_t voxels = 1;
  for (const int nodes : field.dims) voxels *= static_cast<std::uint64_t>(nodes);
  const std::uint64_t bytes_a_voxel =
      std::visit([](const auto* values) { return sizeof(*values); }, field.values);
  const std::uint64_t direct = texels.direct.lattice.active.size();
  const std::uint64_t soft = texels.soft.lattice.active.size();
  // The values, what the first lamps told, soft light as it comes and as it is
  // looked up, and a block as it is and as it goes.
  return voxels * bytes_a_voxel + texels.direct.lattice.texels() * LeafLight<3>::bytes_a_texel +
         swept(texels.direct) + swept(texels.soft) + 3 * soft * (2 * sides - 1) * sizeof(Rgb) +
         2 * std::max(direct, soft) * sides * sizeof(TexelSum);
}

void BlockSweeper::look_up(std::istream& stream) {
  parts_->arena.execute([&] {
    Keeper keeper(stream);
    parts_->bake->keep_looked_up(keeper);
  });
}

std::string BlockSweeper::sweep(SweptLight light, int number) {
  return parts_->arena.execute([&] { return parts_->bake->sweep_for_others(light, number); });
}

}  // namespace leaflight

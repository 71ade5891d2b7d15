// SPDX-License-Identifier: GPL-3.0-or-later
// Measures lookups of a radiance grid at random points, on one thread.
#include <benchmark/benchmark.h>

#include "bake/output/radiance_grid.h"
#include "bench_box.h"

namespace leaflight {
namespace {

// Measures lookups. Argument: number of nodes, and of texels, per axis.
void lookup(benchmark::State& state) {
  const Scene<3> scene = bench::bump_box_scene(static_cast<int>(state.range(0)));
  const Field<3>& field = test::field_of(scene);
  RadianceGrid<3> grid;
  grid.lattice =
      make_lattice<3>(field, field.dims, scene.isovalue_range.min, scene.isovalue_range.max);
  grid.radiance.assign(grid.lattice.active.size(), Vec<3, float>(0.5f));
  const std::vector<Vec3> positions = bench::random_positions(field, 1 << 16);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        leaflight::lookup<3>(field, grid.lattice, grid.radiance, positions[i]));
    if (++i == positions.size()) i = 0;
  }
  state.SetItemsProcessed(state.iterations());
}

BENCHMARK(lookup)->Arg(40)->Arg(100);

}  // namespace
}  // namespace leaflight

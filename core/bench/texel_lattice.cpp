// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the construction of a lattice, which chooses its active texels: wall-clock time of all
// threads.
#include <benchmark/benchmark.h>

#include "bench_box.h"

namespace leaflight {
namespace {

// Measures make_lattice(). Argument: number of nodes, and of texels, per axis.
void make_lattice(benchmark::State& state) {
  const Scene<3> scene = bench::bump_box_scene(static_cast<int>(state.range(0)));
  const Field<3>& field = test::field_of(scene);
  for (auto _ : state) {
    benchmark::DoNotOptimize(leaflight::make_lattice<3>(field, field.dims, scene.isovalue_range.min,
                                                        scene.isovalue_range.max));
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(field.voxels()));
}

BENCHMARK(make_lattice)->Arg(40)->Arg(100)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace leaflight

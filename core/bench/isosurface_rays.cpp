// SPDX-License-Identifier: GPL-3.0-or-later
// Measures rays that leave an isosurface of the bump box and can hit only it, on one thread.
#include <benchmark/benchmark.h>

#include "bench_box.h"
#include "trace/scene_tracer.h"

namespace leaflight {
namespace {

struct Ray {
  SurfacePoint<3> from;
  Vec3 direction;  // into the front
};

// Returns rays that start at random points of the box, on the isosurface through each point.
std::vector<Ray> random_rays(const SceneTracer<3>& tracer) {
  const Field<3>& field = test::field_of(tracer.scene());
  Random random(2);
  std::vector<Ray> rays;
  for (const Vec3& position : bench::random_positions(field, 1 << 14)) {
    const CellPoint<3> point = locate(field, position);
    const double c = interpolate<3>(load_corners(field, point.cell), point.local);
    const SurfacePoint<3> from = tracer.isosurface_point(0, point, c, false);
    if (from.kind() == HitKind::none) continue;
    const Vec3 direction = test::random_direction(random);
    const bool inwards = direction.dot(from.geometric_normal) < 0;
    rays.push_back({from, inwards ? -direction : direction});
  }
  return rays;
}

// Measures answer(tracer, ray) for the rays in turn. Argument: number of nodes per axis.
template <typename Answer>
void trace(benchmark::State& state, const Answer& answer) {
  const Scene<3> scene = bench::bump_box_scene(static_cast<int>(state.range(0)));
  const SceneTracer<3> tracer(scene);
  const std::vector<Ray> rays = random_rays(tracer);
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(answer(tracer, rays[i]));
    if (++i == rays.size()) i = 0;
  }
  state.SetItemsProcessed(state.iterations());
}

void intersect(benchmark::State& state) {
  trace(state, [](const SceneTracer<3>& tracer, const Ray& ray) {
    return tracer.intersect(ray.from, ray.direction).kind;
  });
}

void occluded(benchmark::State& state) {
  trace(state, [](const SceneTracer<3>& tracer, const Ray& ray) {
    return tracer.occluded(ray.from, ray.direction);
  });
}

BENCHMARK(intersect)->Arg(40)->Arg(100);
BENCHMARK(occluded)->Arg(40)->Arg(100);

}  // namespace
}  // namespace leaflight

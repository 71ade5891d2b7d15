// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.h"
#include "bindings.h"
#include "transport/stored_photons.h"

namespace leaflight::python {
namespace {

// Returns photons as points for display (thesis 4.3.5).
template <int D>
py::tuple photon_points(const Scene<D>& scene, std::uint64_t count, std::uint64_t seed,
                        Progress* progress) {
  Progress unwatched;
  std::vector<Vec<D>> positions;
  std::vector<Vec<3, float>> flux;
  std::vector<float> c;
  std::vector<std::uint8_t> direct;
  {
    const py::gil_scoped_release unlocked;
    const SceneTracer<D> tracer(scene);
    const LightSampler<D> lights(tracer);
    Progress& watched = progress ? *progress : unwatched;
    watched.expect(static_cast<double>(count));
    watched.begin("Tracing photons");
    for (const auto& photon : collect_photons(tracer, lights, seed, count, watched)) {
      positions.push_back(Vec<D>(photon.position) / tracer.frame().scale + tracer.frame().center);
      flux.emplace_back(photon.flux_height * static_cast<Real>(scene.isovalue_range.height()));
      c.push_back(static_cast<float>(photon.c));
      direct.push_back(photon.direct);
    }
  }
  const auto n = static_cast<py::ssize_t>(c.size());
  return py::make_tuple(adopt<double>(std::move(positions), {n, D}),
                        adopt<float>(std::move(flux), {n, 3}), adopt<float>(std::move(c), {n}),
                        adopt<std::uint8_t>(std::move(direct), {n}));
}

// Counts the photons that end on surfaces and outside the scene.
template <int D>
py::dict photon_balance(const Scene<D>& scene, std::uint64_t count, std::uint64_t seed) {
  PhotonBalance balance;
  {
    const py::gil_scoped_release unlocked;
    const SceneTracer<D> tracer(scene);
    const LightSampler<D> lights(tracer);
    trace_photons(
        tracer, lights, PhotonPaths::all, seed, 0, count, count, [](const PhotonHit<D>&) {},
        &balance);
  }
  const auto triple = [&](const Imath::V3d& v) {
    const Imath::V3d flux_height = v * scene.isovalue_range.height();
    return std::array<double, 3>{flux_height.x, flux_height.y, flux_height.z};
  };
  py::dict result;
  result["emitted"] = triple(balance.emitted);
  result["absorbed"] = triple(balance.absorbed);
  result["escaped"] = triple(balance.escaped);
  return result;
}

template <int D>
void bind_photon_functions(py::module_& module, const std::string& suffix) {
  module.def(
      ("photon_points" + suffix).c_str(), &photon_points<D>, py::arg("scene"), py::arg("count"),
      py::arg("seed") = 0, py::arg("progress") = nullptr,
      "Traces `count` photons to isosurfaces. Returns (world positions (n, D), flux-heights\n"
      "(n, 3), common isovalues (n,), 1 for photons straight from a light (n,)).");
  module.def(("photon_balance" + suffix).c_str(), &photon_balance<D>, py::arg("scene"),
             py::arg("count"), py::arg("seed") = 0,
             "Traces `count` photons. Returns the flux-heights (r, g, b) that were emitted,\n"
             "absorbed by surfaces, and that left the scene.");
}

}  // namespace

void bind_photons(py::module_& module) {
  bind_photon_functions<3>(module, "");
  bind_photon_functions<2>(module, "2");
}

}  // namespace leaflight::python

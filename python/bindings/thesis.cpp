// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.h"
#include "baked_object.h"
#include "bindings.h"
#include "thesis/fixed_samples.h"

namespace leaflight::python {
namespace {

template <int D>
void bind_fixed_samples(py::module_& module, const std::string& suffix) {
  using Settings = FixedSettings<D>;
  py::class_<Settings>(module, ("FixedSettings" + suffix).c_str(),
                       "Of a bake with a fixed number of samples.")
      .def(py::init<>())
      .def_readwrite("resolution", &Settings::resolution,
                     "Texels along x, y, z; all 0 for one per voxel.")
      .def_readwrite("samples", &Settings::samples,
                     "Samples per texel, each one shadow ray and one gather ray.")
      .def_readwrite("photons", &Settings::photons, "Photons emitted over all isovalues.")
      .def_readwrite("caustic_photons", &Settings::caustic_photons,
                     "Photons emitted for caustics, where there are mirrors or glass.")
      .def_property(
          "estimator", [](const Settings& s) { return traits_of(s.estimator).name; },
          [](Settings& s, const std::string& name) { s.estimator = estimator_from(name); },
          "gather, volumetric, path or thesis.")
      .def_readwrite("seed", &Settings::seed)
      .def_readwrite("threads", &Settings::threads, "0: all.")
      .def_readwrite("both_sides", &Settings::both_sides,
                     "Bake the back too, where light can reach it.")
      .def_readwrite("walls", &Settings::walls,
                     "Bake the radiance of the walls per common isovalue too.")
      .def(
          "set_only_at",
          [](Settings& s, const DoubleArray& points) { s.only_at = to_points<D>(points); },
          py::arg("points"),
          "World points (n, D): bake only the texels that lookups there use, by the estimator "
          "path.")
      .def(
          "set_photon_map",
          [](Settings& s, int k, double radius, double g, const std::string& region) {
            s.photon_map = {k, radius, g, density_region_from(region)};
          },
          py::arg("k") = 200, py::arg("radius") = 0.0, py::arg("g") = 10.0,
          py::arg("region") = "clipped_sphere",
          "Of the estimator `thesis`: the k nearest photons, or those within the radius (shares "
          "of\n"
          "the volume's longest side; 0: no limit), kappa = g * domain / range; region: sphere,\n"
          "clipped_sphere, box, cylinder or graph.")
      .def(
          "set_scattered",
          [](Settings& s, const std::string& strategy, std::size_t count,
             const std::variant<int, std::vector<double>>& isovalues, const std::string& filter,
             int radius) {
            ScatteredBake& scattered = s.scattered.emplace();
            scattered.samples.strategy = sample_strategy_from(strategy);
            scattered.samples.samples = count;
            scattered.samples.isovalues = isovalues;
            scattered.filter = {scattered_filter_from(filter), radius};
          },
          py::arg("strategy"), py::arg("count"), py::arg("isovalues") = 9,
          py::arg("filter") = "shepard", py::arg("radius") = 3,
          "Samples scattered over the domain (uniform, stratified, importance, level_set, "
          "letters,\n"
          "slabs, regular; `isovalues` of level_set: how many, or which) and interpolated "
          "(shepard,\n"
          "tent, box) into texels up to `radius` away, instead of samples in each texel.");
  module.def(
      ("bake_with_fixed_samples" + suffix).c_str(),
      [](const Scene<D>& scene, const Settings& settings, Progress& progress) {
        Baked<D> baked;
        {
          const py::gil_scoped_release unlocked;
          baked = bake_with_fixed_samples(scene, settings, progress);
        }
        return BakedObjects<D>(std::move(baked));
      },
      py::arg("scene"), py::arg("settings"), py::arg("progress"),
      "Lights all isosurfaces of the scene's isovalue range by a fixed number of samples. Raises\n"
      "LeaflightError, or Cancelled.");
}

}  // namespace

void bind_thesis(py::module_& module) {
  bind_fixed_samples<3>(module, "");
  bind_fixed_samples<2>(module, "2");
}

}  // namespace leaflight::python

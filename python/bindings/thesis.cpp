// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.h"
#include "baked_object.h"
#include "thesis/fixed_samples.h"

namespace leaflight::python {
namespace {

// Returns a copy for this module. Each module counts its own large arrays, so bounds for rays,
// which the first ray computes, must begin and end here.
template <int D>
Scene<D> own(const Scene<D>& scene) {
  Scene<D> copy = scene;
  for (Volume<D>& volume : copy.volumes) {
    volume.field.cell_bounds_once = std::make_shared<CellBoundsOnce<D>>();
  }
  return copy;
}

template <int D>
void bind_fixed_samples(py::module_& module, const std::string& suffix) {
  using Settings = FixedSettings<D>;
  py::class_<Settings>(module, ("FixedSettings" + suffix).c_str(),
                       "Settings of a bake with a fixed number of samples.")
      .def(py::init<>())
      .def_readwrite("resolution", &Settings::resolution,
                     "Texels along x, y, z; all 0 for one per voxel.")
      .def_readwrite("samples", &Settings::samples,
                     "Samples per texel, each one shadow ray and one gather ray.")
      .def_readwrite("photons", &Settings::photons, "Number of photons, for all isovalues.")
      .def_readwrite("caustic_photons", &Settings::caustic_photons,
                     "Number of photons for caustics, if there are mirrors or glass.")
      .def_property(
          "estimator", [](const Settings& s) { return traits_of(s.estimator).name; },
          [](Settings& s, const std::string& name) { s.estimator = estimator_from(name); },
          "gather, volumetric, path or thesis.")
      .def_readwrite("seed", &Settings::seed)
      .def_readwrite("threads", &Settings::threads, "Number of threads; 0: all.")
      .def_readwrite("both_sides", &Settings::both_sides,
                     "True to bake the back, too, if light can reach it.")
      .def_readwrite("walls", &Settings::walls,
                     "True to bake the radiance of the walls, too, per common isovalue.")
      .def(
          "set_only_at",
          [](Settings& s, const DoubleArray& points) { s.only_at = to_points<D>(points); },
          py::arg("points"),
          "Bakes only the texels that lookups at these world points (n, D) use, by the\n"
          "estimator path.")
      .def(
          "set_photon_map",
          [](Settings& s, int k, double radius, double g, const std::string& region) {
            s.photon_map = {k, radius, g, density_region_from(region)};
          },
          py::arg("k") = 200, py::arg("radius") = 0.0, py::arg("g") = 10.0,
          py::arg("region") = "clipped_sphere",
          "Sets the estimator `thesis`: it uses the k nearest photons, at most within the\n"
          "radius (a share of the volume's longest side; 0: no limit), with kappa = g * domain\n"
          "/ range. region: sphere, clipped_sphere, box, cylinder or graph.")
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
          "Replaces samples in each texel by samples scattered over the domain (uniform,\n"
          "stratified, importance, level_set, letters, slabs, regular). They are interpolated\n"
          "(shepard, tent, box) into texels up to `radius` away. isovalues: for level_set,\n"
          "their number or a list.");
  module.def(("bake_with_fixed_samples" + suffix).c_str(),
             [](const Scene<D>& scene, const Settings& settings, Progress& progress) {
               Baked<D> baked;
               {
                 const py::gil_scoped_release unlocked;
                 baked = bake_with_fixed_samples(own(scene), settings, progress);
               }
               return BakedObjects<D>(std::move(baked), scene);
             },
             py::arg("scene"), py::arg("settings"), py::arg("progress"),
             "Lights all isosurfaces of the scene's isovalue range by a fixed number of samples.\n"
             "Raises LeaflightError, Cancelled.");
}

}  // namespace
}  // namespace leaflight::python

// Scenes, Progress, bakes and errors are those of _core, which registers their types.
PYBIND11_MODULE(_thesis, module) {
  module.doc() = "The methods of the thesis, for comparison with the bakes of leaflight.";
  pybind11::module_::import("leaflight._core");
  leaflight::python::bind_fixed_samples<3>(module, "");
  leaflight::python::bind_fixed_samples<2>(module, "2");
}

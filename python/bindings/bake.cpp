// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/bake.h"

#include <pybind11/stl/filesystem.h>

#include "bake/driver/pass_schedule.h"
#include "baked_object.h"
#include "bindings.h"
#include "io/checkpoint_file.h"
#include "workers.h"

namespace leaflight::python {
namespace {

namespace fs = std::filesystem;

template <int D>
void bind_settings(py::module_& module, const std::string& suffix) {
  using Settings = BakeSettings<D>;
  py::class_<Settings>(module, ("BakeSettings" + suffix).c_str())
      .def(py::init<>())
      .def_readwrite("resolution", &Settings::resolution,
                     "Texels along x, y, z; all 0: chosen by the bake.")
      .def_readwrite("error", &Settings::error, "Target RMS error of colors, in percent.")
      .def_readwrite("seconds", &Settings::seconds, "Time limit in seconds; 0: none.")
      .def_readwrite("seed", &Settings::seed)
      .def_readwrite("threads", &Settings::threads, "Number of threads; 0: all.")
      .def_readwrite("exposure", &Settings::exposure, "Factor from radiance to displayed color.")
      .def_readwrite("both_sides", &Settings::both_sides,
                     "True to bake the back, too, if light can reach it.")
      .def_readwrite("walls", &Settings::walls,
                     "True to bake the radiance of the walls, too, per common isovalue.");
}

std::vector<std::tuple<std::string, std::string>> pairs_of(
    const std::vector<SkippedPass>& skipped) {
  std::vector<std::tuple<std::string, std::string>> pairs;
  for (const SkippedPass& one : skipped) pairs.emplace_back(one.pass, one.reason);
  return pairs;
}

void bind_statistics(py::module_& module) {
  using Statistics = BakeStatistics;
  py::class_<Statistics>(module, "BakeStatistics", "The cost of a bake and its estimated error.")
      .def_readonly("seconds", &Statistics::seconds)
      .def_readonly("rays", &Statistics::rays, "Number of traced rays, including lines.")
      .def_readonly("peak_memory_bytes", &Statistics::peak_memory_bytes,
                    "Peak memory of the process in bytes.")
      .def_property_readonly(
          "skipped", [](const Statistics& statistics) { return pairs_of(statistics.skipped); },
          "(name, reason) of each pass that the scene does not need.")
      .def_readonly("passes", &Statistics::passes)
      .def_readonly("blocks", &Statistics::blocks, "Number of averaged blocks of indirect light.")
      .def_readonly("noise_percent", &Statistics::noise_percent)
      .def_readonly("error_percent", &Statistics::error_percent,
                    "Estimated error in percent, including noise.")
      .def_property_readonly(
          "worst_isovalue", [](const Statistics& statistics) { return statistics.worst.c; },
          "Common isovalue with the largest error.")
      .def_property_readonly(
          "worst_error_percent",
          [](const Statistics& statistics) { return statistics.worst.percent; },
          "Estimated error at worst_isovalue in percent.")
      .def_readonly("stopped", &Statistics::stopped,
                    "True if time or the caller ended it before the target error.")
      .def_readonly("continued", &Statistics::continued,
                    "True if it contains the light of the previous bake.");
}

template <int D>
void bind_baking(py::module_& module, const std::string& suffix) {
  py::class_<BakedObjects<D>>(module, ("Baked" + suffix).c_str())
      .def_readonly("grids", &BakedObjects<D>::grids, "List of RadianceGrids, one per volume.")
      .def_readonly("walls", &BakedObjects<D>::walls, "WallRadiance, or None if it was not baked.")
      .def_readonly("statistics", &BakedObjects<D>::statistics)
      .def_readonly("texels", &BakedObjects<D>::texels,
                    "Number of texels with radiance, of all volumes.");
  module.def(("skipped_passes" + suffix).c_str(),
             [](const Scene<D>& scene, const BakeSettings<D>& settings) {
               return pairs_of(make_plan(scene, settings).skipped);
             },
             py::arg("scene"), py::arg("settings"),
             "Returns (name, reason) of each pass that a bake of the scene does not need.");
  module.def(
      ("bake" + suffix).c_str(),
      [](const Scene<D>& scene, const BakeSettings<D>& settings, Progress& progress,
         const py::object& on_pass,
         const std::optional<std::tuple<std::vector<std::shared_ptr<GridObject<D>>>, int, int>>&
             previous,
         const std::optional<std::tuple<fs::path, std::string, double>>& checkpoint,
         const std::optional<fs::path>& resumed, const py::object& workers) {
        BakeHooks<D> hooks;
        if (!on_pass.is_none()) {
          hooks.on_pass = [&](Baked<D>&& baked) {
            const py::gil_scoped_acquire locked;
            on_pass(BakedObjects<D>(std::move(baked), scene));
          };
        }
        Baked<D> baked;
        {
          const py::gil_scoped_release unlocked;
          std::vector<PreviousLight<D>> light;
          if (previous) {
            const auto& [grids, passes, blocks] = *previous;
            for (const auto& grid : grids) light.emplace_back(*grid->baked, passes, blocks);
            hooks.previous = &light;
          }
          Workers calls;
          if (!workers.is_none()) {
            calls = workers_of(workers);
            hooks.workers = &calls;
          }
          Checkpoints checkpoints;
          hooks.checkpoints = &checkpoints;
          if (checkpoint) {
            const auto& [path, text, seconds] = *checkpoint;
            checkpoints.seconds = seconds;
            checkpoints.save = [&, &path = path, &text = text](const Checkpoints::Write& write) {
              try {
                write_checkpoint(path, text, write);
              } catch (const Error& failure) {
                // Continue the bake, because a full disk may have space at its end.
                const py::gil_scoped_acquire locked;
                if (PyErr_WarnEx(PyExc_RuntimeWarning, failure.what(), 1) < 0) {
                  throw py::error_already_set();
                }
              }
            };
          }
          if (resumed) {
            checkpoints.restore = [&](const Checkpoints::Read& read) {
              read_checkpoint_state(*resumed, read);
            };
          }
          baked = bake(scene, settings, progress, hooks);
        }
        return BakedObjects<D>(std::move(baked), scene);
      },
      py::arg("scene"), py::arg("settings"), py::arg("progress"), py::arg("on_pass") = py::none(),
      py::arg("previous") = py::none(), py::arg("checkpoint") = py::none(),
      py::arg("resumed") = py::none(), py::arg("workers") = py::none(),
      "Lights all isosurfaces of the scene's isovalue range. `on_pass` receives the bake\n"
      "after each pass except the last, in the thread that bakes. `previous`: (grids,\n"
      "passes, blocks) of a bake to continue. `checkpoint`: (file, text, seconds); the bake\n"
      "saves its state and the text to this file at this interval. `resumed`: such a file,\n"
      "of the same scene and settings, from which the bake continues. `workers`: an object\n"
      "whose PartTracers compute parts of it. send(kind, data) gives data to all, which parts\n"
      "announced later look up. announce(parts) begins parts, bytes each, and returns the\n"
      "number of the first. take(number) returns the result of a part, or b\"\" to make the bake\n"
      "compute it. drop(first, count) forgets parts. Raises LeaflightError, Cancelled.");
}

}  // namespace

void bind_bake(py::module_& module) {
  bind_statistics(module);
  bind_settings<3>(module, "");
  bind_baking<3>(module, "");
  bind_settings<2>(module, "2");
  bind_baking<2>(module, "2");
  module.def("noise_to_reach", &noise_to_reach, py::arg("error"), py::arg("bias"),
             "The noise in percent at which a bake with this target error ends. bias: all other "
             "errors in\n"
             "percent, such as detail finer than the texels.");
}

}  // namespace leaflight::python

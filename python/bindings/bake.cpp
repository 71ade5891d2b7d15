// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/driver/bake.h"

#include <pybind11/stl/filesystem.h>

#include "arrays.h"
#include "bake/driver/rounds.h"
#include "bindings.h"
#include "grid_object.h"
#include "io/checkpoint_file.h"
#include "thesis/thesis.h"
#include "workers.h"

namespace leaflight::python {
namespace {

namespace fs = std::filesystem;

template <int D>
py::dict statistics(const Baked<D>& baked) {
  py::list skipped;
  for (const SkippedPass& pass : baked.statistics.skipped) {
    skipped.append(std::vector<std::string>{pass.pass, pass.reason});
  }
  std::size_t texels = 0;
  for (const RadianceGrid<D>& grid : baked.grids) texels += grid.texels();
  py::dict result;
  result["seconds"] = baked.statistics.seconds;
  result["rays"] = baked.statistics.rays;
  result["texels"] = texels;
  result["peak_memory_bytes"] = baked.statistics.peak_memory_bytes;
  result["skipped_passes"] = skipped;
  result["rounds"] = baked.statistics.rounds;
  result["estimated_noise_percent"] = baked.statistics.noise_percent;
  result["estimated_error_percent"] = baked.statistics.error_percent;
  result["worst_isovalue"] = baked.statistics.worst.c;
  result["worst_error_percent"] = baked.statistics.worst.percent;
  result["blocks"] = baked.statistics.blocks;
  result["stopped"] = baked.statistics.stopped;
  return result;
}

template <int D>
ThesisSettings thesis_of(const BakeSettings<D>& settings) {
  return settings.thesis ? *settings.thesis : ThesisSettings{};
}

template <int D>
void bind_settings(py::module_& module, const std::string& suffix) {
  using Settings = BakeSettings<D>;
  py::class_<Settings>(module, ("BakeSettings" + suffix).c_str())
      .def(py::init<>())
      .def_readwrite("resolution", &Settings::resolution,
                     "Texels along x, y, z; all 0 for one per voxel.")
      .def_readwrite("samples", &Settings::samples,
                     "Samples per texel, each one shadow ray and one gather ray; 0: rounds.")
      .def_readwrite("error", &Settings::error,
                     "Of rounds: the RMS error of colours to reach, in percent.")
      .def_readwrite("seconds", &Settings::seconds,
                     "Of rounds: no more begin after so many; 0: no limit.")
      .def_readwrite("photons", &Settings::photons, "Photons emitted over all isovalues.")
      .def_readwrite("caustic_photons", &Settings::caustic_photons,
                     "Photons emitted for caustics, where there are mirrors or glass.")
      .def_property(
          "estimator", [](const Settings& s) { return traits_of(s.estimator).name; },
          [](Settings& s, const std::string& name) { s.estimator = estimator_from(name); },
          "gather, volumetric, path or thesis.")
      .def_readwrite("seed", &Settings::seed)
      .def_readwrite("threads", &Settings::threads, "0: all.")
      .def_readwrite("exposure", &Settings::exposure, "Radiance times this is a displayed colour.")
      .def_readwrite("both_sides", &Settings::both_sides,
                     "Bake the inner side too, where light can reach it.")
      .def_readwrite("surroundings", &Settings::surroundings,
                     "Bake the radiance of the surroundings per leaf coordinate too.")
      .def(
          "set_only_at",
          [](Settings& s, const DoubleArray& points) { s.only_at = to_points<D>(points); },
          py::arg("points"),
          "World points (n, D): bake only the texels that lookups there use, by the estimator "
          "path.")
      .def(
          "set_photon_map",
          [](Settings& s, int k, double radius, double g, const std::string& region) {
            ThesisSettings thesis = thesis_of(s);
            thesis.photon_map = {k, radius, g, density_region_from(region)};
            s.thesis = std::make_shared<const ThesisSettings>(thesis);
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
            ThesisSettings thesis = thesis_of(s);
            ScatteredBake& scattered = thesis.scattered.emplace();
            scattered.samples.strategy = sample_strategy_from(strategy);
            scattered.samples.samples = count;
            scattered.samples.isovalues = isovalues;
            scattered.filter = {scattered_filter_from(filter), radius};
            s.thesis = std::make_shared<const ThesisSettings>(thesis);
          },
          py::arg("strategy"), py::arg("count"), py::arg("isovalues") = 9,
          py::arg("filter") = "shepard", py::arg("radius") = 3,
          "Samples strewn over the domain (uniform, stratified, importance, level_set, letters,\n"
          "slabs, regular; `isovalues` of level_set: how many, or which) and interpolated "
          "(shepard,\n"
          "tent, box) into texels up to `radius` away, instead of samples in each texel.");
}

// Grids and surroundings become objects of their own, which live as long as Python needs them.
template <int D>
struct BakedObjects {
  std::vector<std::shared_ptr<GridObject<D>>> grids;
  std::shared_ptr<SurroundingsRadiance<D>> surroundings;
  py::dict statistics;

  explicit BakedObjects(Baked<D>&& baked) : statistics(python::statistics(baked)) {
    for (RadianceGrid<D>& grid : baked.grids) {
      grids.push_back(std::make_shared<GridObject<D>>(std::move(grid)));
    }
    if (!baked.surroundings.empty()) {
      surroundings = std::make_shared<SurroundingsRadiance<D>>(std::move(baked.surroundings));
    }
  }
};

template <int D>
void bind_baking(py::module_& module, const std::string& suffix) {
  py::class_<BakedObjects<D>>(module, ("Baked" + suffix).c_str())
      .def_readonly("grids", &BakedObjects<D>::grids, "A RadianceGrid per volume.")
      .def_readonly("surroundings", &BakedObjects<D>::surroundings,
                    "SurroundingsRadiance, or None if it was not baked.")
      .def_readonly("statistics", &BakedObjects<D>::statistics);
  module.def(
      ("bake" + suffix).c_str(),
      [](const Scene<D>& scene, const BakeSettings<D>& settings, Progress& progress,
         const py::object& on_round,
         const std::optional<std::tuple<std::vector<std::shared_ptr<GridObject<D>>>, int, int>>&
             kept,
         const std::optional<std::tuple<fs::path, std::string, double>>& checkpoint,
         const std::optional<fs::path>& resumed, const py::object& workers) {
        BakeHooks<D> hooks;
        if (!on_round.is_none()) {
          hooks.on_round = [&](Baked<D>&& baked) {
            const py::gil_scoped_acquire locked;
            on_round(BakedObjects<D>(std::move(baked)));
          };
        }
        Baked<D> baked;
        {
          const py::gil_scoped_release unlocked;
          std::vector<KeptLight<D>> light;
          if (kept) {
            const auto& [grids, rounds, blocks] = *kept;
            for (const auto& grid : grids) light.emplace_back(*grid->baked, rounds, blocks);
            hooks.kept = &light;
          }
          BlockWorkers block_workers;
          if (!workers.is_none()) {
            block_workers = workers_of(workers);
            hooks.workers = &block_workers;
          }
          Checkpoints checkpoints;
          hooks.checkpoints = &checkpoints;
          if (checkpoint) {
            const auto& [path, text, seconds] = *checkpoint;
            checkpoints.seconds = seconds;
            checkpoints.save = [&, &path = path, &text = text](const Checkpoints::Write& write) {
              try {
                write_checkpoint(path, text, write);
              } catch (const Error&) {
                // A disk that is full now may have space by the end of the bake.
              }
            };
          }
          const auto run = [&] { baked = bake(scene, settings, progress, hooks); };
          if (resumed) {
            read_checkpoint_state(*resumed, [&](std::istream& stream) {
              checkpoints.from = &stream;
              run();
            });
          } else {
            run();
          }
        }
        return BakedObjects<D>(std::move(baked));
      },
      py::arg("scene"), py::arg("settings"), py::arg("progress"), py::arg("on_round") = py::none(),
      py::arg("kept") = py::none(), py::arg("checkpoint") = py::none(),
      py::arg("resumed") = py::none(), py::arg("workers") = py::none(),
      "Lights all leaves of the scene's window. `on_round` is given what is baked after each\n"
      "round but the last, from the thread that bakes. `kept`: (grids, rounds, blocks) of a\n"
      "bake to go on with. `checkpoint`: (file, text, seconds): the bake leaves\n"
      "its state there, with the text, so many seconds apart. `resumed`: such a file, of a bake "
      "of\n"
      "the same scene and settings, to go on from. `workers`: an object that has blocks of light\n"
      "swept by BlockSweepers: begin(first, count, state) announces the blocks [first,\n"
      "first + count), and what their lines look up, bytes;\n"
      "take(number) returns one of them, or b\"\", and the bake sweeps it itself. Raises\n"
      "LeaflightError, or Cancelled.");
}

}  // namespace

void bind_bake(py::module_& module) {
  bind_settings<3>(module, "");
  bind_baking<3>(module, "");
  bind_settings<2>(module, "2");
  bind_baking<2>(module, "2");
  module.def(
      "noise_to_reach", &noise_to_reach, py::arg("error"), py::arg("texture"),
      "Percent of noise at which a bake ends that is asked for an error (percent) and whose\n"
      "texels miss some of the light (percent).");
}

}  // namespace leaflight::python

// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/bake.h"

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "arrays.h"
#include "bindings.h"
#include "leaflight/bake/atlas.h"
#include "leaflight/surface/split_edges.h"
#include "leaflight/transport/reference.h"

namespace leaflight::python {
namespace {

// Of all levels.
template <int D>
std::size_t texels_of(const RadianceGrid<D>& grid) {
  return grid.lattice.active.size() + (grid.finer ? texels_of(*grid.finer) : 0);
}

template <int D>
py::dict statistics(const Baked<D>& baked) {
  py::list skipped;
  for (const SkippedPass& pass : baked.statistics.skipped) {
    skipped.append(std::vector<std::string>{pass.pass, pass.reason});
  }
  std::size_t texels = 0;
  for (const RadianceGrid<D>& grid : baked.grids) texels += texels_of(grid);
  py::dict result;
  result["seconds"] = baked.statistics.seconds;
  result["rays"] = baked.statistics.rays;
  result["texels"] = texels;
  result["peak_memory_bytes"] = baked.statistics.peak_memory_bytes;
  result["skipped_passes"] = skipped;
  return result;
}

template <int D, class Value>
py::array_t<float> spread(const TexelLattice<D>& lattice, const std::vector<Value>& values,
                          std::vector<py::ssize_t> shape) {
  std::vector<Value> dense(lattice.texels(), Value(0));
  for (std::size_t s = 0; s < values.size(); ++s) dense[lattice.active[s]] = values[s];
  return adopt<float>(std::move(dense), std::move(shape));
}

template <int D>
const std::vector<Vec<3, float>>& side_of(const RadianceGrid<D>& grid, bool back) {
  if (back && !grid.has_back()) {
    throw Error("This bake does not hold the inner side of its isosurfaces; bake both sides.");
  }
  return back ? grid.radiance_back : grid.radiance;
}

template <int D>
int levels_of(const RadianceGrid<D>& grid) {
  return 1 + (grid.finer ? levels_of(*grid.finer) : 0);
}

template <int D>
const RadianceGrid<D>& level_of(const RadianceGrid<D>& grid, int level) {
  if (level < 0 || level >= levels_of(grid)) {
    throw Error("The grid has no level " + std::to_string(level) + "; it has " +
                std::to_string(levels_of(grid)) + ", numbered from 0.");
  }
  return level == 0 ? grid : level_of(*grid.finer, level - 1);
}

template <int D>
py::array_t<float> dense(const RadianceGrid<D>& whole, const std::string& name, int level) {
  const RadianceGrid<D>& grid = level_of(whole, level);
  std::vector<py::ssize_t> shape = array_shape(grid.lattice.resolution);
  if (name == "radiance_error") return spread(grid.lattice, grid.radiance_error, shape);
  shape.push_back(3);
  if (name == "radiance") return spread(grid.lattice, grid.radiance, shape);
  if (name == "radiance_indirect") return spread(grid.lattice, grid.radiance_indirect, shape);
  if (name == "radiance_back") return spread(grid.lattice, side_of(grid, true), shape);
  throw Error("A bake has no grid '" + name +
              "'; choose radiance, radiance_indirect, radiance_back or radiance_error.");
}

template <int D>
py::array_t<std::uint8_t> mask(const RadianceGrid<D>& whole, int level) {
  const RadianceGrid<D>& grid = level_of(whole, level);
  std::vector<std::uint8_t> active(grid.lattice.texels(), 0);
  for (const std::uint32_t texel : grid.lattice.active) active[texel] = 1;
  return adopt<std::uint8_t>(std::move(active), array_shape(grid.lattice.resolution));
}

template <int D>
py::array_t<float> lookup_at(const RadianceGrid<D>& grid, const Field<D>& field,
                             const DoubleArray& array, bool back) {
  const std::vector<Vec<D>> points = to_points<D>(array);
  static_cast<void>(side_of(grid, back));
  std::vector<Vec<3, float>> radiance(points.size());
  {
    const py::gil_scoped_release unlocked;
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
      const Vec<D> position = field.world_to_index.point(points[i]);
      const RadianceGrid<D>& from = grid.at(position);
      radiance[i] = lookup(from.lattice, side_of(from, back), position);
    });
  }
  return adopt<float>(std::move(radiance), {static_cast<py::ssize_t>(points.size()), 3});
}

// How many times texels were halved where a grid is looked up.
int level_at(const RadianceGrid<3>& grid, const Vec3& index_position) {
  const RadianceGrid<3>* const finest = &grid.at(index_position);
  int level = 0;
  for (const RadianceGrid<3>* g = &grid; g != finest; g = g->finer.get()) ++level;
  return level;
}

py::tuple contour_of(const RadianceGrid<3>& grid, const Field<3>& field, double isovalue) {
  IsosurfaceMesh mesh;
  {
    const py::gil_scoped_release unlocked;
    mesh = contour(field, isovalue);
    for (int level = 1; level < levels_of(grid); ++level) {
      mesh = split_edges(field, isovalue, mesh,
                         [&](const Vec3& middle) { return level_at(grid, middle) >= level; });
    }
  }
  return arrays_of(std::move(mesh));
}

template <int D>
py::array_t<float> lookup_error_at(const RadianceGrid<D>& grid, const Field<D>& field,
                                   const DoubleArray& array) {
  const std::vector<Vec<D>> points = to_points<D>(array);
  std::vector<float> error;
  for (const Vec<D>& point : points) {
    const Vec<D> position = field.world_to_index.point(point);
    const RadianceGrid<D>& from = grid.at(position);
    error.push_back(lookup_error(from.lattice, from.radiance_error, position));
  }
  return adopt<float>(std::move(error), {static_cast<py::ssize_t>(points.size())});
}

py::tuple atlas(const RadianceGrid<3>& grid, bool back) {
  const std::vector<Vec<3, float>>& values = side_of(grid, back);
  Atlas result;
  {
    const py::gil_scoped_release unlocked;
    result = make_atlas(grid.lattice, values);
  }
  const int columns = result.columns, rows = result.rows;
  return py::make_tuple(adopt<float>(std::move(result.pixels), {result.height, result.width, 4}),
                        columns, rows);
}

py::tuple arrays_of(const std::vector<ReferenceRadiance>& result) {
  std::vector<Vec<3, float>> radiance, error;
  for (const ReferenceRadiance& r : result) {
    radiance.emplace_back(r.radiance);
    error.emplace_back(r.standard_error);
  }
  const auto n = static_cast<py::ssize_t>(result.size());
  return py::make_tuple(adopt<float>(std::move(radiance), {n, 3}),
                        adopt<float>(std::move(error), {n, 3}));
}

template <int D, class Points>
py::tuple trace_reference(const Scene<D>& scene, const Points& points,
                          const ReferenceSettings& settings, int threads, Progress* progress) {
  if (settings.samples < 1) throw Error("The reference needs at least one sample per point.");
  Progress own;
  std::vector<ReferenceRadiance> result;
  {
    const py::gil_scoped_release unlocked;
    tbb::task_arena arena(threads > 0 ? threads : tbb::task_arena::automatic);
    result = arena.execute(
        [&] { return reference_radiance(scene, points, settings, progress ? *progress : own); });
  }
  return arrays_of(result);
}

template <int D>
py::tuple reference(const Scene<D>& scene, const DoubleArray& points, double c, int samples,
                    std::uint64_t seed, int threads, Progress* progress, int volume, bool back) {
  return trace_reference(scene, to_points<D>(points), {c, samples, seed, volume, back}, threads,
                         progress);
}

// facets (n,), coordinates (n, 2): barycentric, of each facet's second and third vertex.
template <int D>
py::tuple reference_surroundings(const Scene<D>& scene, int mesh, const std::vector<int>& facets,
                                 const DoubleArray& coordinates, double c, int samples,
                                 std::uint64_t seed, int threads, Progress* progress, bool back) {
  if (rows(coordinates, 2, "coordinates") != static_cast<py::ssize_t>(facets.size())) {
    throw Error("There must be one row of coordinates for each facet.");
  }
  std::vector<FacetPoint> points;
  for (std::size_t i = 0; i < facets.size(); ++i) {
    const auto row = static_cast<py::ssize_t>(i);
    points.push_back({mesh, facets[i], coordinates.at(row, 0), coordinates.at(row, 1), !back});
  }
  return trace_reference(scene, points, {c, samples, seed, 0, false}, threads, progress);
}

template <int D>
void bind_settings(py::module_& module, const std::string& suffix) {
  using Settings = BakeSettings<D>;
  py::class_<Settings>(module, ("BakeSettings" + suffix).c_str())
      .def(py::init<>())
      .def_readwrite("resolution", &Settings::resolution,
                     "Texels along x, y, z; all 0 for one per voxel.")
      .def_readwrite("samples", &Settings::samples,
                     "Samples per texel, each one shadow ray and one gather ray.")
      .def_readwrite("photons", &Settings::photons, "Photons emitted over all isovalues.")
      .def_readwrite("caustic_photons", &Settings::caustic_photons,
                     "Photons emitted for caustics, where there are mirrors or glass.")
      .def_property(
          "estimator", [](const Settings& s) { return name_of(s.estimator); },
          [](Settings& s, const std::string& name) { s.estimator = estimator_from(name); },
          "gather, volumetric, path or thesis.")
      .def_readwrite("seed", &Settings::seed)
      .def_readwrite("threads", &Settings::threads, "0: all.")
      .def_readwrite("soft_spacing", &Settings::soft_spacing,
                     "Texels between the points that soft light is gathered at, 1: each texel.")
      .def_readwrite("refine", &Settings::refine,
                     "How many times texels are halved where light varies most.")
      .def_readwrite("exposure", &Settings::exposure,
                     "Radiance times this is a displayed colour; `refine` goes by colours.")
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
            s.photon_map = {k, radius, g, density_region_from(region), s.photon_map.direct};
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
            ScatteredBake scattered;
            scattered.samples.strategy = sample_strategy_from(strategy);
            scattered.samples.samples = count;
            scattered.samples.isovalues = isovalues;
            scattered.filter = {scattered_filter_from(filter), radius};
            s.scattered = scattered;
          },
          py::arg("strategy"), py::arg("count"), py::arg("isovalues") = 9,
          py::arg("filter") = "shepard", py::arg("radius") = 3,
          "Samples strewn over the domain (uniform, stratified, importance, level_set, letters,\n"
          "slabs, regular; `isovalues` of level_set: how many, or which) and interpolated "
          "(shepard,\n"
          "tent, box) into texels up to `radius` away, instead of samples in each texel.");
}

// The photons as points, for a look at them (thesis 4.3.5).
template <int D>
py::tuple photon_points(const Scene<D>& scene, std::uint64_t count, std::uint64_t seed,
                        Progress* progress) {
  Progress own;
  std::vector<Vec<D>> positions;
  std::vector<Vec<3, float>> flux;
  std::vector<float> c;
  std::vector<std::uint8_t> direct;
  {
    const py::gil_scoped_release unlocked;
    const SceneTracer<D> tracer(scene);
    const LightSampler<D> lights(tracer);
    std::uint64_t rays = 0;
    Progress& watched = progress ? *progress : own;
    watched.expect(static_cast<double>(count));
    watched.begin("Tracing photons");
    for (const auto& photon : collect_photons(tracer, lights, seed, count, watched, rays)) {
      positions.push_back(Vec<D>(photon.position) / tracer.frame().scale + tracer.frame().centre);
      flux.emplace_back(photon.flux_height * static_cast<Real>(scene.window.height()));
      c.push_back(static_cast<float>(photon.c));
      direct.push_back(photon.direct);
    }
  }
  const auto n = static_cast<py::ssize_t>(c.size());
  return py::make_tuple(adopt<double>(std::move(positions), {n, D}),
                        adopt<float>(std::move(flux), {n, 3}), adopt<float>(std::move(c), {n}),
                        adopt<std::uint8_t>(std::move(direct), {n}));
}

// Photons from lights to surfaces and out of the scene.
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
    const Imath::V3d flux_height = v * scene.window.height();
    return std::array<double, 3>{flux_height.x, flux_height.y, flux_height.z};
  };
  py::dict result;
  result["emitted"] = triple(balance.emitted);
  result["absorbed"] = triple(balance.absorbed);
  result["escaped"] = triple(balance.escaped);
  return result;
}

template <int D>
void bind_grid(py::module_& module, const std::string& suffix) {
  using Grid = RadianceGrid<D>;
  py::class_<Grid, std::shared_ptr<Grid>> grid(
      module, ("RadianceGrid" + suffix).c_str(),
      "The radiance [W/(m^2 sr)] of every leaf of one volume within a window.");
  grid.def_property_readonly("resolution", [](const Grid& g) { return g.lattice.resolution; })
      .def_property_readonly("texels", &texels_of<D>, "Active texels of all levels.")
      .def_property_readonly("levels", &levels_of<D>,
                             "1, and one for each time that texels were halved somewhere.")
      .def_property_readonly("has_back", &Grid::has_back, "Whether the inner side was baked.")
      .def("dense", &dense<D>, py::arg("name"), py::arg("level") = 0,
           "radiance, radiance_indirect (all but the lights' direct light) or radiance_back (the\n"
           "inner side): float32 [z, y, x, 3]; radiance_error, the standard error of the mean\n"
           "over the channels: float32 [z, y, x]. Zero at inactive texels. Those of level 1 and\n"
           "above are half as wide, serve some cells alone and have 2 n - 1 where n were.")
      .def("mask", &mask<D>, py::arg("level") = 0, "uint8 [z, y, x], 1 at active texels.")
      .def("lookup", &lookup_at<D>, py::arg("field"), py::arg("points"), py::arg("back") = false,
           "Linear radiance (n, 3) at world points (n, D), over active texels only.")
      .def("lookup_error", &lookup_error_at<D>, py::arg("field"), py::arg("points"),
           "Standard error (n,) of the outer side's radiance at world points (n, D), of the mean\n"
           "over the channels: that of independent texels.");
  if constexpr (D == 3) {
    grid.def("contour", &contour_of, py::arg("field"), py::arg("isovalue"),
             "contour() of the volume that the grid lights, with edges cut in two as often as "
             "texels\nwere halved there, so that vertices show the finer texels.");
    grid.def("atlas", &atlas, py::arg("back") = false,
             "(pixels float32 [row, column, RGBA] bottom row first, columns, rows): slice k of "
             "the\ntexture is the tile in column k % columns and row k // columns, without "
             "padding.");
  }
}

template <int D>
void bind_surroundings(py::module_& module, const std::string& suffix) {
  using Surroundings = SurroundingsRadiance<D>;
  py::class_<Surroundings, std::shared_ptr<Surroundings>>(
      module, ("SurroundingsRadiance" + suffix).c_str(),
      "The radiance of the surroundings over the leaf coordinate, at the vertices of fine meshes.")
      .def_property_readonly(
          "count", [](const Surroundings& s) { return s.radiance.size(); }, "Number of meshes.")
      .def(
          "mesh",
          [](const Surroundings& s, std::size_t i) {
            std::vector<Vec<D, float>> vertices = s.meshes.at(i).vertices;
            std::vector<std::array<std::int32_t, static_cast<std::size_t>(D)>> facets;
            for (const auto& facet : s.meshes.at(i).facets) {
              auto& numbers = facets.emplace_back();
              std::copy(facet.begin(), facet.end(), numbers.begin());
            }
            const auto n = static_cast<py::ssize_t>(vertices.size());
            const auto m = static_cast<py::ssize_t>(facets.size());
            return py::make_tuple(adopt<float>(std::move(vertices), {n, D}),
                                  adopt<std::int32_t>(std::move(facets), {m, D}));
          },
          py::arg("mesh"), "(vertices float32 (n, D) world, facets int32 (m, D)).")
      .def(
          "places",
          [](const Surroundings& s, std::size_t i) {
            std::vector<std::int32_t> facets;
            std::vector<std::array<double, 2>> coordinates;
            for (const FacetPoint& p : s.meshes.at(i).places) {
              facets.push_back(p.facet);
              coordinates.push_back({p.u, p.v});
            }
            const auto n = static_cast<py::ssize_t>(facets.size());
            return py::make_tuple(adopt<std::int32_t>(std::move(facets), {n}),
                                  adopt<double>(std::move(coordinates), {n, 2}));
          },
          py::arg("mesh"),
          "Where the vertices were lit: (facets int32 (n,) of the original mesh, barycentric\n"
          "coordinates (n, 2)), for reference_surroundings().")
      .def(
          "radiance",
          [](const Surroundings& s, std::size_t i, double c, bool back) {
            static_cast<void>(s.meshes.at(i));
            auto radiance = radiance_at(s, static_cast<int>(i), c, back);
            const auto n = static_cast<py::ssize_t>(radiance.size());
            return adopt<float>(std::move(radiance), {n, 3});
          },
          py::arg("mesh"), py::arg("c"), py::arg("back") = false,
          "float32 (n, 3) at the vertices of a fine mesh, seen from its normals' side or from\n"
          "behind; linear in the leaf coordinate.");
}

// Grids and surroundings become objects of their own, which live as long as Python needs them.
template <int D>
struct BakedObjects {
  std::vector<std::shared_ptr<RadianceGrid<D>>> grids;
  std::shared_ptr<SurroundingsRadiance<D>> surroundings;
  py::dict statistics;

  explicit BakedObjects(Baked<D>&& baked) : statistics(python::statistics(baked)) {
    for (RadianceGrid<D>& grid : baked.grids) {
      grids.push_back(std::make_shared<RadianceGrid<D>>(std::move(grid)));
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
  module.def(("bake" + suffix).c_str(),
             [](const Scene<D>& scene, const BakeSettings<D>& settings, Progress& progress) {
               Baked<D> baked;
               {
                 const py::gil_scoped_release unlocked;
                 baked = bake(scene, settings, progress);
               }
               return BakedObjects<D>(std::move(baked));
             },
             py::arg("scene"), py::arg("settings"), py::arg("progress"),
             "Lights all leaves of the scene's window. Raises LeaflightError, or Cancelled.");
  module.def(("photon_points" + suffix).c_str(), &photon_points<D>, py::arg("scene"),
             py::arg("count"), py::arg("seed") = 0, py::arg("progress") = nullptr,
             "Where `count` emitted photons met leaves: (world positions (n, D), flux-height\n"
             "(n, 3), leaf coordinate (n,), 1 where they came straight from a light (n,)).");
  module.def(("photon_balance" + suffix).c_str(), &photon_balance<D>, py::arg("scene"),
             py::arg("count"), py::arg("seed") = 0,
             "Flux-height (r, g, b) that `count` photons emitted, lost at surfaces and took out\n"
             "of the scene.");
  module.def(("reference" + suffix).c_str(), &reference<D>, py::arg("scene"), py::arg("points"),
             py::arg("c"), py::arg("spp"), py::arg("seed") = 0, py::arg("threads") = 0,
             py::arg("progress") = nullptr, py::arg("volume") = 0, py::arg("back") = false,
             "Radiance of a volume's leaf by path tracing at world points (n, D): (radiance\n"
             "(n, 3), standard error (n, 3)). Unbiased, save for caustics of lights without\n"
             "extent, which no path meets.");
  module.def(("reference_surroundings" + suffix).c_str(), &reference_surroundings<D>,
             py::arg("scene"), py::arg("mesh"), py::arg("facets"), py::arg("coordinates"),
             py::arg("c"), py::arg("spp"), py::arg("seed") = 0, py::arg("threads") = 0,
             py::arg("progress") = nullptr, py::arg("back") = false,
             "The same at points of a mesh of the surroundings: facets (n,) and barycentric\n"
             "coordinates (n, 2), seen from the normals' side or from behind.");
}

}  // namespace

void bind_bake(py::module_& module) {
  bind_settings<3>(module, "");
  bind_grid<3>(module, "");
  bind_surroundings<3>(module, "");
  bind_baking<3>(module, "");
  bind_settings<2>(module, "2");
  bind_grid<2>(module, "2");
  bind_surroundings<2>(module, "2");
  bind_baking<2>(module, "2");
}

}  // namespace leaflight::python

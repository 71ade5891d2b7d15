// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/output/radiance_grid.h"

#include <tbb/parallel_for.h>

#include "arrays.h"
#include "bake/output/atlas.h"
#include "bake/output/estimated_grid.h"
#include "bake/output/lit_contour.h"
#include "base/parallel.h"
#include "bindings.h"
#include "grid_object.h"
#include "mesh_arrays.h"
#include "transport/indirect_shares.h"

namespace leaflight::python {
namespace {

// Returns an array of the texels, or of one of their layers on caps (cap_layers.h).
template <int D, class Value>
py::array_t<float> spread(const TexelLattice<D>& lattice, const std::vector<Value>& values,
                          int layer, std::vector<py::ssize_t> shape) {
  std::vector<Value> dense(lattice.texels(), Value(0));
  for (std::size_t s = 0; s < lattice.active.size(); ++s) {
    if (lattice.layer(s) == layer) dense[lattice.active[s]] = values[s];
  }
  return adopt<float>(std::move(dense), std::move(shape));
}

// Returns the number of layers, the value in the middle of the first, and their step; or None.
template <int D>
py::object cap_layers(const GridObject<D>& grid) {
  const TexelLattice<D>& lattice = grid.baked->lattice;
  if (!lattice.has_layers()) return py::none();
  return py::make_tuple(lattice.layers, lattice.layer_value(0), lattice.layer_step);
}

// Returns all light of one side's texels, as baked.
template <int D>
std::vector<Vec<3, float>> all_light(const GridObject<D>& grid, bool back) {
  // Another thread may keep the light meanwhile, so derive it.
  const py::gil_scoped_release unlocked;
  std::vector<Vec<3, float>> light(grid.baked->texels());
  parallel_each(light.size(), [&](std::size_t s) {
    light[s] = derived_radiance(*grid.baked, *grid.lit, s, back);
  });
  return light;
}

// Returns the radiance of one side's texels at some slots, or its indirect part.
template <int D>
std::vector<Vec<3, float>> texels_at(const GridObject<D>& grid,
                                     const std::vector<std::uint32_t>& slots, bool back,
                                     bool indirect_alone) {
  const RadianceGrid<D>& from = *grid.baked;
  const ShownGrid<D> shown = grid.shown();
  check_light(shown, back);
  const std::vector<Vec<3, float>>& indirect =
      back ? from.radiance_back_indirect : from.radiance_indirect;
  const std::vector<Vec<3, float>>& kept = back ? from.radiance_back : from.radiance;
  const bool is_kept = kept.size() == from.texels();
  std::vector<Vec<3, float>> texels(slots.size());
  const py::gil_scoped_release unlocked;
  parallel_each(slots.size(), [&](std::size_t i) {
    const std::size_t s = slots[i];
    const Vec<3, float> part = indirect.empty() ? Vec<3, float>(0) : indirect[s];
    const Vec<D> center = from.lattice.center(from.lattice.active[s]);
    Vec<3, float> light;
    if (grid.field) {
      light = shown.scaled(part, *grid.field, center);
      if (!indirect_alone) light += Vec<3, float>(grid.direct->radiance(*grid.field, center, back));
    } else if (indirect_alone) {
      light = part;
    } else {
      light = is_kept ? kept[s] : derived_radiance(from, *grid.lit, s, back);
    }
    texels[i] = shown.textured(light, center);
  });
  return texels;
}

// Returns at most `most` slots, evenly spread over all.
template <int D>
std::vector<std::uint32_t> spread_slots(const RadianceGrid<D>& grid, std::size_t most) {
  std::vector<std::uint32_t> slots(std::min(most, grid.texels()));
  for (std::size_t i = 0; i < slots.size(); ++i) {
    slots[i] = static_cast<std::uint32_t>(i * grid.texels() / slots.size());
  }
  return slots;
}

// Returns the radiance of all texels of one side, or its indirect part.
template <int D>
std::vector<Vec<3, float>> texels_of(const GridObject<D>& grid, bool back, bool indirect_alone) {
  return texels_at(grid, spread_slots(*grid.baked, grid.baked->texels()), back, indirect_alone);
}

// Returns standard errors of texels at some slots.
template <int D>
std::vector<float> errors_at(const GridObject<D>& grid, const std::vector<std::uint32_t>& slots) {
  std::vector<float> errors(slots.size());
  const auto factor = average(Rgb(grid.indirect));
  for (std::size_t i = 0; i < slots.size(); ++i) {
    errors[i] = grid.baked->radiance_error[slots[i]] * factor;
  }
  return errors;
}

template <int D>
py::tuple some_texels(const GridObject<D>& grid, std::size_t most) {
  const std::vector<std::uint32_t> slots = spread_slots(*grid.baked, most);
  const auto n = static_cast<py::ssize_t>(slots.size());
  return py::make_tuple(adopt<float>(texels_at(grid, slots, false, false), {n, 3}),
                        adopt<float>(errors_at(grid, slots), {n}));
}

template <int D>
py::array_t<float> dense(const GridObject<D>& grid, const std::string& name, int layer) {
  const RadianceGrid<D>& from = *grid.baked;
  std::vector<py::ssize_t> shape = array_shape(from.lattice.resolution);
  if (name == "radiance_error") {
    return spread(from.lattice, errors_at(grid, spread_slots(from, from.texels())), layer, shape);
  }
  shape.push_back(3);
  for (const bool back : {false, true}) {
    for (const bool indirect : {false, true}) {
      const std::string side_name = std::string("radiance") + (back ? "_back" : "");
      if (name != side_name + (indirect ? "_indirect" : "")) continue;
      return spread(from.lattice, texels_of(grid, back, indirect), layer, shape);
    }
  }
  throw Error("A bake has no grid '" + name +
              "'; choose radiance, radiance_indirect, radiance_back, radiance_back_indirect or "
              "radiance_error.");
}

template <int D>
Vec<3, float> indirect_at(const ShownGrid<D>& shown, const Field<D>& field,
                          const Vec<D>& index_position, bool back) {
  const RadianceGrid<D>& grid = shown.grid;
  const auto& texels = back ? grid.radiance_back_indirect : grid.radiance_indirect;
  const Vec<3, float> light = lookup(field, grid.lattice, texels, index_position);
  return shown.textured(shown.scaled(light, field, index_position), index_position);
}

template <int D, class Array>
py::array_t<float> lookup_of(const GridObject<D>& grid, const Field<D>& field, const Array& points,
                             bool back, bool indirect) {
  const py::ssize_t n = rows(points, D, "points");
  const ShownGrid<D> shown = grid.shown();
  check_light(shown, back);
  std::vector<Vec<3, float>> radiance(n);
  {
    const auto* coordinates = points.data();
    const py::gil_scoped_release unlocked;
    tbb::parallel_for(py::ssize_t{0}, n, [&](py::ssize_t i) {
      Vec<D> point;
      for (int a = 0; a < D; ++a) point[a] = coordinates[D * i + a];
      check_point(point);
      const Vec<D> position = field.world_to_index.point(point);
      radiance[i] = indirect ? indirect_at(shown, field, position, back)
                             : radiance_at(shown, field, position, back);
    });
  }
  return adopt<float>(std::move(radiance), {n, 3});
}

// Reads float32 points in place, such as those of a mesh, and others as double precision.
template <int D>
py::array_t<float> lookup_at(const GridObject<D>& grid, const Field<D>& field,
                             const py::object& points, bool back, bool indirect) {
  if (py::isinstance<FloatArray>(points)) {
    return lookup_of(grid, field, py::reinterpret_borrow<FloatArray>(points), back, indirect);
  }
  const auto numbers = DoubleArray::ensure(points);
  if (!numbers) throw Error("The points must be an array of numbers, one row for each.");
  return lookup_of(grid, field, numbers, back, indirect);
}

py::tuple lit_contour_of(const GridObject<3>& grid, const Field<3>& field, double isovalue,
                         bool normals, bool front, bool back, float largest_step) {
  const std::shared_ptr<LitMesh> mesh = mesh_to_fill();
  {
    const py::gil_scoped_release unlocked;
    lit_contour(grid.shown(), field, isovalue, {normals, front, back, largest_step}, *mesh);
  }
  return mesh_arrays(mesh) + py::make_tuple(rows_of<float>(mesh, mesh->radiance),
                                            rows_of<float>(mesh, mesh->radiance_back),
                                            mesh->contoured);
}

template <int D>
py::array_t<float> lookup_error_at(const GridObject<D>& grid, const Field<D>& field,
                                   const DoubleArray& array) {
  const std::vector<Vec<D>> points = to_points<D>(array);
  const RadianceGrid<D>& from = *grid.baked;
  std::vector<float> error;
  for (const Vec<D>& point : points) {
    const Vec<D> position = field.world_to_index.point(point);
    error.push_back(lookup_error(field, from.lattice, from.radiance_error, position) *
                    average(Rgb(grid.indirect)));
  }
  return adopt<float>(std::move(error), {static_cast<py::ssize_t>(points.size())});
}

// Computes all light of the texels as baked and keeps it. An atlas holds it, and a cut that follows
// its box reads it at each step.
void complete(const GridObject<3>& grid) {
  if (grid.field) return;
  RadianceGrid<3>& baked = *grid.baked;
  for (const bool back : {false, true}) {
    if (back && !baked.has_back()) continue;
    std::vector<Vec<3, float>>& kept = back ? baked.radiance_back : baked.radiance;
    if (kept.size() == baked.texels()) continue;
    check_light(ShownGrid<3>(baked), back);
    std::vector<Vec<3, float>> light = all_light(grid, back);
    // Another thread may have kept it meanwhile, and may read it.
    if (kept.size() != baked.texels()) kept = std::move(light);
  }
}

py::tuple atlas(const GridObject<3>& grid, bool back) {
  complete(grid);
  const std::vector<Vec<3, float>> values = texels_of(grid, back, false);
  Atlas result;
  {
    const py::gil_scoped_release unlocked;
    result = make_atlas(grid.baked->lattice, values);
  }
  const int columns = result.columns, rows = result.rows;
  return py::make_tuple(adopt<float>(std::move(result.pixels), {result.height, result.width, 4}),
                        columns, rows);
}

GridObject<3> estimated(const GridObject<3>& grid, const Field<3>& before, const Field<3>& now,
                        const Index<3>& resolution, const Tuple<2>& isovalues, bool direct) {
  if (direct) complete(grid);
  RadianceGrid<3> shown;
  const RadianceGrid<3>* texels = grid.baked.get();
  if (grid.field) {
    // Texels hold the light as baked, not as shown. Lookups multiply by the texture.
    GridObject<3> plain = grid;
    plain.texture = nullptr;
    shown.lattice = texels->lattice;
    shown.radiance = texels_of(plain, false, false);
    shown.radiance_indirect = texels_of(plain, false, true);
    if (texels->has_back()) {
      shown.radiance_back = texels_of(plain, true, false);
      shown.radiance_back_indirect = texels_of(plain, true, true);
    }
    texels = &shown;
  }
  const py::gil_scoped_release unlocked;
  return GridObject<3>(
      estimated_grid(*texels, before, now, resolution, {isovalues[0], isovalues[1]}, direct));
}

template <int D>
void bind_grid(py::module_& module, const std::string& suffix) {
  using Grid = GridObject<D>;
  py::class_<Grid, std::shared_ptr<Grid>> grid(
      module, ("RadianceGrid" + suffix).c_str(),
      "The radiance [W/(m^2 sr)] of every isosurface of one volume within an isovalue range.");
  grid.def_property_readonly("resolution",
                             [](const Grid& g) { return g.baked->lattice.resolution; })
      .def_property_readonly(
          "texels", [](const Grid& g) { return g.baked->texels(); }, "Number of active texels.")
      .def_property_readonly(
          "map_resolution",
          [](const Grid& g) -> std::optional<Index<D>> {
            if (!g.baked->direct) return std::nullopt;
            return g.baked->direct->lattice().resolution;
          },
          "Resolution of the visibility maps from which lookups compute direct light; None:\n"
          "texels contain all light.")
      .def_property_readonly(
          "can_be_relit",
          [](const Grid& g) { return g.baked->derives_radiance(g.baked->has_back()); },
          "True if the direct light of all sides is exact.")
      .def(
          "relit",
          [](const Grid& g, const std::shared_ptr<Field<D>>& field,
             const std::vector<Tuple<3>>& lights, const Tuple<3>& indirect) {
            if (!g.baked->derives_radiance(g.baked->has_back()))
              throw Error("Texels hold direct light; it cannot be scaled.");
            Grid relit = g;
            relit.field = field;
            relit.direct =
                std::make_shared<const DirectLight<D>>(g.baked->direct->scaled(to_colors(lights)));
            relit.indirect = Vec<3, float>(to_color(indirect));
            return relit;
          },
          py::arg("field"), py::arg("lights"), py::arg("indirect"),
          "Returns the grid of the lit field with other strengths of the scene's lights:\n"
          "factors (r, g, b) for each, relative to the bake. `indirect`: factor on other light,\n"
          "except emission. Shares the texels. Requires can_be_relit.")
      .def_property_readonly(
          "has_back", [](const Grid& g) { return g.baked->has_back(); },
          "True if the back was baked.")
      .def_property_readonly("cap_layers", &cap_layers<D>,
                             "(number, value in the middle of the first, step) of the layers of "
                             "isovalues that texels\n"
                             "on the cap of a cut have; None without such texels.")
      .def("dense", &dense<D>, py::arg("name"), py::arg("layer") = -1,
           "Returns the grid of this name. radiance, radiance_indirect (without the lights'\n"
           "direct light), radiance_back and radiance_back_indirect: float32 [z, y, x, 3].\n"
           "radiance_error, the standard error of the mean over the channels: float32 [z, y, x].\n"
           "Inactive texels are zero. layer: one of cap_layers, which only texels on a cap have.")
      .def("some_texels", &some_texels<D>, py::arg("most"),
           "Returns the front's (radiance float32 (n, 3), radiance_error (n,)) of at most `most`\n"
           "active texels, evenly spread over all.")
      .def(
          "mask", [](const Grid& g) { return active_mask(g.baked->lattice); },
          "uint8 [z, y, x], 1 at active texels.")
      .def("lookup", &lookup_at<D>, py::arg("field"), py::arg("points"), py::arg("back") = false,
           py::arg("indirect") = false,
           "Returns the radiance (n, 3) of the isosurfaces through world points (n, D);\n"
           "indirect: only the part in radiance_indirect.")
      .def("lookup_error", &lookup_error_at<D>, py::arg("field"), py::arg("points"),
           "Returns the standard error (n,) of the front's radiance at world points (n, D),\n"
           "averaged over the channels, for independent errors of texels.");
  if constexpr (D == 3) {
    grid.def_property_readonly(
        "direct",
        [](const Grid& g) {
          return std::const_pointer_cast<DirectLight<D>>(g.field ? g.direct : g.baked->direct);
        },
        "DirectLight that lookups add; None: texels contain all light. A bake in passes has\n"
        "it.");
    grid.def(
        "stored_direct",
        [](const Grid& g, const Scene<3>& scene, int volume) {
          const py::gil_scoped_release unlocked;
          if (!g.baked->maps) throw Error("The file of this bake has no visibility maps.");
          const std::shared_ptr<const StoredMaps<3>> maps = std::exchange(g.baked->maps, nullptr);
          const SceneTracer<3> tracer(scene);
          try {
            return std::make_shared<DirectLight<3>>(tracer, volume, split_light(tracer).points,
                                                    *maps);
          } catch (const std::runtime_error&) {
            throw Error("The visibility maps of this bake are damaged; bake the volume again.");
          }
        },
        py::arg("scene"), py::arg("volume"),
        "Takes the maps of the scene's volume from a grid of read_bake(), and returns its\n"
        "DirectLight. Raises LeaflightError.");
    grid.def(
        "add_direct",
        [](Grid& g, const std::shared_ptr<Field<D>>& field,
           const std::shared_ptr<DirectLight<D>>& direct) {
          g.baked->direct = direct;
          g.lit = field;
        },
        py::arg("field"), py::arg("direct"),
        "Gives a grid from a file the DirectLight that its bake had, and the lit field.");
    grid.def(
        "with_texture",
        [](const Grid& g, const std::optional<std::shared_ptr<VolumeTexture<D>>>& texture) {
          Grid textured = g;
          textured.texture = texture.value_or(nullptr);
          return textured;
        },
        py::arg("texture"),
        "Returns the grid with another texture, VolumeTexture.on() its field, by which lookups\n"
        "multiply the light; None: no texture. A grid from a file has none. Shares the texels.");
    grid.def(
        "moved",
        [](const Grid& g, const std::shared_ptr<Field<D>>& field,
           const std::shared_ptr<DirectLight<D>>& direct, const Tuple<3>& indirect) {
          Grid moved = g;
          moved.field = field;
          moved.direct = direct;
          moved.indirect = Vec<3, float>(to_color(indirect));
          return moved;
        },
        py::arg("field"), py::arg("direct"), py::arg("indirect"),
        "Returns the grid with the direct light of another scene. Other light, except\n"
        "emission, is scaled by (r, g, b). field: the volume at its current position. Shares\n"
        "the texels.");
    grid.def("estimated", &estimated, py::arg("before"), py::arg("now"), py::arg("resolution"),
             py::arg("isovalues"), py::arg("direct"),
             "Returns a grid without visibility maps for changed values of the volume. Near\n"
             "changes it has the mean light of the isosurfaces that lights reach, by their\n"
             "normals. before, now: the baked and the changed field, at one place. resolution:\n"
             "that of the result. isovalues: the baked range, in values of the field. direct:\n"
             "False leaves out direct light, which is faster; moved() adds it.");
    grid.def("lit_contour", &lit_contour_of, py::arg("field"), py::arg("isovalue"),
             py::arg("normals") = false, py::arg("front") = true, py::arg("back") = false,
             py::arg("largest_step") = LitContourSettings{}.largest_step,
             "Returns (vertices, normals, triangles, radiance, radiance of the back, number of\n"
             "triangles before edges were split): contour(), and lookup() at its vertices. Arrays\n"
             "are float32 (n, 3) and int32 (m, 3), or None if not requested. Edges are split as\n"
             "often as texels are narrower than voxels, so that vertices show them. Small meshes\n"
             "also split edges whose ends differ by more than largest_step in radiance, at most\n"
             "twice. It is fastest if all arrays of the previous call are released.");
    grid.def("atlas", &atlas, py::arg("back") = false,
             "Returns (pixels float32 [row, column, RGBA] bottom row first, columns, rows). Slice\n"
             "k is the tile in column k % columns and row k // columns, without padding.");
  }
}

}  // namespace

void bind_radiance_grid(py::module_& module) {
  py::class_<IndirectShares>(module, "IndirectShares",
                             "The share of each light of a scene in the indirect light.")
      .def(py::init([](const Scene<3>& scene) {
             const py::gil_scoped_release unlocked;
             return indirect_shares(SceneTracer<3>(scene));
           }),
           py::arg("scene"))
      .def_property_readonly(
          "total",
          [](const IndirectShares& shares) {
            const Imath::V3d total = shares.total();
            return py::make_tuple(total.x, total.y, total.z);
          },
          "Sum of all shares, (r, g, b).")
      .def(
          "factor",
          [](const IndirectShares& shares, const std::vector<Tuple<3>>& lights) {
            const Rgb factor = shares.factor(to_colors(lights));
            return py::make_tuple(factor.x, factor.y, factor.z);
          },
          py::arg("lights"),
          "Returns the growth of indirect light, (r, g, b), if each light of the scene is\n"
          "scaled by factors (r, g, b).");
  bind_grid<3>(module, "");
  bind_grid<2>(module, "2");
}

}  // namespace leaflight::python

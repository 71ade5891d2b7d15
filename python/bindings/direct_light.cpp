// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/direct/direct_light.h"

#include "arrays.h"
#include "bindings.h"

namespace leaflight::python {
namespace {

using Direct = DirectLight<3>;
using Quadruple = std::array<double, 4>;

Quadruple quadruple(const Vec<3>& v, double last) { return {v.x, v.y, v.z, last}; }

std::array<Quadruple, 4> row_of(const LightSource<3>& source) {
  const bool fades = source.cone && source.cone->cosine_falloff;
  const double shines =
      fades || !(source.infinite || source.sphere) ? source.both_sides ? 2 : 1 : 0;
  const Vec<3> normal = fades ? source.cone->axis : source.normal;
  const double edge = source.cone ? (1 - source.cone->cosine) * source.cone->blend : 0;
  return {source.infinite ? quadruple(-source.direction, 0) : quadruple(source.position, 1),
          quadruple(shines > 0 ? normal : Vec<3>(0.0), shines),
          quadruple(Vec<3>(source.amount), edge),
          source.cone ? quadruple(source.cone->axis, source.cone->cosine) : Quadruple{0, 0, 0, -2}};
}

py::array_t<double> light_points(const Direct& direct) {
  std::vector<std::array<Quadruple, 4>> rows;
  for (std::size_t n = 0; n < direct.points(); ++n) rows.push_back(row_of(direct.point(n).source));
  const auto count = static_cast<py::ssize_t>(rows.size());
  return adopt<double>(std::move(rows), {count, 4, 4});
}

py::array_t<std::int32_t> lights(const Direct& direct) {
  std::vector<std::int32_t> lights;
  for (std::size_t n = 0; n < direct.points(); ++n) lights.push_back(direct.point(n).light);
  const auto count = static_cast<py::ssize_t>(lights.size());
  return adopt<std::int32_t>(std::move(lights), {count});
}

py::array_t<std::uint8_t> codes(const Direct& direct, std::size_t point, bool back) {
  if (point >= direct.points() || (back && !direct.has_back())) {
    throw Error("There is no map of light point " + std::to_string(point) + " for this side.");
  }
  std::vector<std::uint8_t> codes(direct.lattice().active.size());
  for (std::size_t s = 0; s < codes.size(); ++s) codes[s] = direct.code(point, s, back);
  const auto count = static_cast<py::ssize_t>(codes.size());
  return adopt<std::uint8_t>(std::move(codes), {count});
}

}  // namespace

void bind_direct_light(py::module_& module) {
  module.def(
      "map_resolution",
      [](const Field<3>& field, const Tuple<2>& isovalues, const Index<3>& texels,
         std::size_t points) {
        return map_resolution(field, {isovalues[0], isovalues[1]}, texels, points);
      },
      py::arg("field"), py::arg("isovalues"), py::arg("texels"), py::arg("points"),
      py::call_guard<py::gil_scoped_release>(),
      "Returns the resolution of maps for this number of light points: that of the texels, or\n"
      "a coarser one if it would take too much memory.");
  py::class_<Direct, std::shared_ptr<Direct>>(
      module, "DirectLight",
      "Direct light of every isosurface of one volume, from visibility maps. For each texel\n"
      "of a lattice and each light point they hold the greatest value between the two, as a\n"
      "byte.")
      .def(py::init([](const Scene<3>& scene, int volume, const Index<3>& resolution, bool back,
                       Progress& progress, double spacing, const Direct* earlier) {
             const py::gil_scoped_release unlocked;
             const SceneTracer<3> tracer(scene);
             const std::vector<LightPoint<3>> points = split_light(tracer).points;
             progress.expect_more((back ? 2 : 1) * static_cast<double>(points.size()) *
                                  static_cast<double>(cell_count<3>(resolution)) *
                                  MapSweeps<3>::work_of_texel);
             if (earlier && back && !earlier->has_back()) earlier = nullptr;
             return std::make_shared<Direct>(tracer, volume, points,
                                             MapSettings<3>{resolution, back, spacing}, progress,
                                             earlier);
           }),
           py::arg("scene"), py::arg("volume"), py::arg("resolution"), py::arg("back"),
           py::arg("progress"), py::arg("spacing") = 1.0, py::arg("earlier") = nullptr,
           "Computes the maps of a scene's volume. resolution: texels of the maps along x, y, z;\n"
           "back: includes the backs; spacing: upper bound on the voxels between the lines that\n"
           "find shadows; earlier: direct light of the same scene under other lights, whose maps\n"
           "are reused for points that have not moved. Raises Cancelled.")
      .def_property_readonly(
          "resolution", [](const Direct& d) { return d.lattice().resolution; },
          "Texels along x, y, z, evenly spaced from the first voxel to the last.")
      .def_property_readonly(
          "light_points", &light_points,
          "float64 (n, 4, 4), four rows for each point. Row 0: position in the frame and 1, or\n"
          "direction to a light at infinity and 0. Row 1: normal and 1, or 2 if it emits on\n"
          "both sides, or 0 if it has none. Row 2: linear RGB irradiance [W/m^2] of a surface\n"
          "that faces it at distance 1 in the frame, and width of the soft edge of its cone, in\n"
          "cosines. Row 3: axis of the cone, and cosine at its end or -2 without a cone.")
      .def_property_readonly("lights", &lights,
                             "int32 (n,): number of each point's light in the scene, or -1.")
      .def_property_readonly(
          "index_to_frame", [](const Direct& d) { return from_affine(d.index_to_frame()); },
          "float64 (4, 4): from indices to the frame, which is the world, moved and scaled\n"
          "uniformly.")
      .def_property_readonly(
          "code_range",
          [](const Direct& d) { return std::pair(d.code_range().min, d.code_range().max); },
          "(lo, hi): the values that codes can distinguish, slightly more than the isovalue\n"
          "range.")
      .def_property_readonly("has_back", &Direct::has_back, "True if backs have maps.")
      .def("codes", &codes, py::arg("point"), py::arg("back") = false,
           "Returns the codes of the active texels for a light point, uint8 (n,), in the order\n"
           "of mask(). An isosurface h is lit at a texel if its own code is greater: 1 + 252 (h\n"
           "- lo) / (hi - lo) within code_range (lo, hi). 255 is behind a mesh. back: codes of\n"
           "backs, which begin at hi.")
      .def(
          "mask", [](const Direct& d) { return active_mask(d.lattice()); },
          "uint8 [z, y, x], 1 at active texels.");
}

}  // namespace leaflight::python

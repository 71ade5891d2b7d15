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
  py::class_<Direct, std::shared_ptr<Direct>>(
      module, "DirectLight",
      "Maps of the direct light of every isosurface of one volume: for each texel of a "
      "lattice\n"
      "and each light point the greatest value of the volume on the way between them, as a byte.")
      .def(py::init([](const Scene<3>& scene, int volume, const Index<3>& resolution, bool back,
                       Progress& progress, double spacing, const Direct* earlier) {
             const py::gil_scoped_release unlocked;
             if (!fits_maps(scene.volumes.at(volume).field, resolution)) {
               throw Error("The maps of direct light are of another volume; bake it again.");
             }
             const SceneTracer<3> tracer(scene);
             const std::vector<LightPoint<3>> points = split_light(tracer).points;
             progress.expect_more((back ? 2 : 1) * static_cast<double>(points.size()) *
                                  static_cast<double>(cell_count<3>(resolution)) *
                                  Direct::work_of_texel);
             if (earlier && back && !earlier->has_back()) earlier = nullptr;
             return std::make_shared<Direct>(tracer, volume, points, resolution, back, progress,
                                             spacing, earlier);
           }),
           py::arg("scene"), py::arg("volume"), py::arg("resolution"), py::arg("back"),
           py::arg("progress"), py::arg("spacing") = 1.0, py::arg("earlier") = nullptr,
           "Of a scene's volume by its number. resolution: texels of the maps along x, y, z;\n"
           "back: also of the backs; spacing: voxels between the lines that find shadows, or\n"
           "texels where these are nearer to each other; earlier: where lights alone were others,\n"
           "whose maps serve for the points that have not moved. Raises Cancelled.")
      .def_property_readonly(
          "resolution", [](const Direct& d) { return d.lattice().resolution; },
          "Texels along x, y, z, evenly spaced from the first voxel to the last.")
      .def_property_readonly(
          "light_points", &light_points,
          "float64 (n, 4, 4), four rows for each point:\n"
          "its position in the frame and 1, or the direction to light from afar and 0;\n"
          "the normal along which it shines and 1, or 2 for both ways, or 0 for all directions;\n"
          "linear RGB irradiance [W/m^2] of a surface that faces it at distance 1 in the frame,\n"
          "and how wide the soft edge of its cone is, in cosines;\n"
          "the axis of the cone and the cosine at which it ends, -2 for none.")
      .def_property_readonly("lights", &lights,
                             "int32 (n,): the number of the scene's light that each point belongs "
                             "to, or -1.")
      .def_property_readonly(
          "index_to_frame", [](const Direct& d) { return from_affine(d.index_to_frame()); },
          "float64 (4, 4): the frame is the world, moved and scaled uniformly.")
      .def_property_readonly(
          "code_range",
          [](const Direct& d) { return std::pair(d.code_range().min, d.code_range().max); },
          "(lo, hi): the values that codes tell apart, a little more than the isovalue range.")
      .def_property_readonly("has_back", &Direct::has_back, "Whether backs have maps.")
      .def("codes", &codes, py::arg("point"), py::arg("back") = false,
           "uint8 (n,) of the active texels, in the order of mask(), for a light point. An "
           "isosurface is\n"
           "lit at a texel if the code of its isovalue h is greater: 1 + 252 (h - lo) / (hi - lo)\n"
           "within code_range (lo, hi). 255 is behind a mesh. back: of backs, whose codes\n"
           "begin at hi.")
      .def(
          "mask", [](const Direct& d) { return active_mask(d.lattice()); },
          "uint8 [z, y, x], 1 at active texels.");
}

}  // namespace leaflight::python

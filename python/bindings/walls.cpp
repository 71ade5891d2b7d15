// SPDX-License-Identifier: GPL-3.0-or-later
#include "arrays.h"
#include "bake/walls/wall_radiance.h"
#include "bindings.h"

namespace leaflight::python {
namespace {

template <int D>
py::array_t<float> indirect(const WallRadiance<D>& walls, std::size_t mesh, bool back) {
  std::vector<Vec<3, float>> radiance = walls.radiance.at(mesh)[back];
  const auto vertices = static_cast<py::ssize_t>(walls.meshes[mesh].coarse.vertices.size());
  radiance.resize(IsovalueNodes::count * vertices, Vec<3, float>(0));
  return adopt<float>(std::move(radiance), {IsovalueNodes::count, vertices, 3});
}

template <int D>
py::array_t<std::uint32_t> between(const WallRadiance<D>& walls, std::size_t mesh) {
  auto pairs = walls.meshes.at(mesh).between;
  const auto count = static_cast<py::ssize_t>(pairs.size());
  return adopt<std::uint32_t>(std::move(pairs), {count, 2});
}

template <int D>
py::tuple direct_ways(const WallRadiance<D>& walls, std::size_t mesh) {
  static_cast<void>(walls.meshes.at(mesh));
  const auto& traced = walls.direct->rays(static_cast<int>(mesh));
  std::vector<float> greatest, shares, least = traced.least;
  for (const auto& ray : traced.rays) {
    greatest.push_back(ray.greatest);
    shares.push_back(ray.share);
  }
  const auto vertices = static_cast<py::ssize_t>(traced.sets.size());
  const auto points = static_cast<py::ssize_t>(walls.direct->sets()[0].size());
  const auto unshadowed = [&](bool back) {
    const std::size_t lights = walls.direct->lights();
    std::vector<Vec<3, float>> all;
    for (std::size_t light = 0; light < lights; ++light) {
      const auto one = walls.direct->unshadowed_by(light, static_cast<int>(mesh), back);
      all.insert(all.end(), one.begin(), one.end());
    }
    return adopt<float>(std::move(all), {static_cast<py::ssize_t>(lights), vertices, 3});
  };
  return py::make_tuple(
      adopt<std::uint8_t>(std::vector(traced.sets), {vertices}),
      least.empty() ? py::object(py::none()) : adopt<float>(std::move(least), {vertices, points}),
      adopt<float>(std::move(greatest), {vertices, points}),
      adopt<float>(std::move(shares), {vertices, points}), unshadowed(false), unshadowed(true));
}

template <int D>
py::array_t<float> point_amounts(const WallRadiance<D>& walls) {
  std::vector<Vec<3, float>> amounts;
  for (const auto& set : walls.direct->sets()) {
    for (const LightPoint<D>& point : set) amounts.emplace_back(point.source.amount);
  }
  const auto points = static_cast<py::ssize_t>(amounts.size()) / light_point_sets;
  return adopt<float>(std::move(amounts), {light_point_sets, points, 3});
}

template <int D>
py::array_t<std::int32_t> point_lights(const WallRadiance<D>& walls) {
  std::vector<std::int32_t> lights;
  for (const LightPoint<D>& point : walls.direct->sets()[0]) lights.push_back(point.light);
  const auto points = static_cast<py::ssize_t>(lights.size());
  return adopt<std::int32_t>(std::move(lights), {points});
}

template <int D>
void bind_radiance(py::module_& module, const std::string& suffix) {
  using Walls = WallRadiance<D>;
  py::class_<Walls, std::shared_ptr<Walls>>(
      module, ("WallRadiance" + suffix).c_str(),
      "The radiance of the walls over the common isovalue, at the vertices of fine meshes.")
      .def_property_readonly(
          "count", [](const Walls& s) { return s.radiance.size(); }, "Number of meshes.")
      .def_property_readonly(
          "nodes",
          [](const Walls& s) {
            std::vector<double> nodes;
            for (int i = 0; i < IsovalueNodes::count; ++i) nodes.push_back(s.nodes.node(i));
            return nodes;
          },
          "The common isovalues, ascending, between which indirect light is linear.")
      .def(
          "mesh",
          [](const Walls& s, std::size_t i) {
            std::vector<Vec<D, float>> vertices = s.meshes.at(i).fine.vertices;
            std::vector<std::array<std::int32_t, static_cast<std::size_t>(D)>> facets;
            for (const auto& facet : s.meshes.at(i).fine.facets) {
              auto& numbers = facets.emplace_back();
              std::copy(facet.begin(), facet.end(), numbers.begin());
            }
            const auto n = static_cast<py::ssize_t>(vertices.size());
            const auto m = static_cast<py::ssize_t>(facets.size());
            return py::make_tuple(adopt<float>(std::move(vertices), {n, D}),
                                  adopt<std::int32_t>(std::move(facets), {m, D}));
          },
          py::arg("mesh"), "Returns (vertices float32 (n, D) world, facets int32 (m, D)).")
      .def(
          "places",
          [](const Walls& s, std::size_t i) {
            std::vector<std::int32_t> facets;
            std::vector<std::array<double, 2>> coordinates;
            for (const FacetPoint& p : s.meshes.at(i).fine.places) {
              facets.push_back(p.facet);
              coordinates.push_back({p.u, p.v});
            }
            const auto n = static_cast<py::ssize_t>(facets.size());
            return py::make_tuple(adopt<std::int32_t>(std::move(facets), {n}),
                                  adopt<double>(std::move(coordinates), {n, 2}));
          },
          py::arg("mesh"),
          "Returns the positions at which vertices are lit: (facets int32 (n,) of the original\n"
          "mesh, barycentric coordinates (n, 2)), for reference_walls().")
      .def(
          "radiance",
          [](const Walls& s, std::size_t i, double c, bool back) {
            static_cast<void>(s.meshes.at(i));
            std::vector<Vec<3, float>> radiance;
            {
              const py::gil_scoped_release unlocked;
              radiance = radiance_at(s, static_cast<int>(i), c, back);
            }
            const auto n = static_cast<py::ssize_t>(radiance.size());
            return adopt<float>(std::move(radiance), {n, 3});
          },
          py::arg("mesh"), py::arg("c"), py::arg("back") = false,
          "Returns float32 (n, 3) at the vertices of a fine mesh, seen from the side of its\n"
          "normals or from behind.")
      .def(
          "relit",
          [](const Walls& s, const Scene<D>& scene, const std::vector<Tuple<3>>& lights,
             const Tuple<3>& indirect) {
            const py::gil_scoped_release unlocked;
            return std::make_shared<Walls>(
                relit(s, scene.meshes, to_colors(lights), Vec<3, float>(to_color(indirect))));
          },
          py::arg("scene"), py::arg("lights"), py::arg("indirect"),
          "Returns the walls with other strengths of the scene's lights, as in\n"
          "RadianceGrid.relit().")
      .def(
          "moved",
          [](const Walls& s, const Scene<D>& earlier, const Scene<D>& scene,
             const std::vector<int>& same_as, const Tuple<3>& factor, Progress& progress,
             std::size_t share, bool lights_alone) {
            const py::gil_scoped_release unlocked;
            return std::make_shared<Walls>(moved(s, earlier, scene, same_as,
                                                 Vec<3, float>(to_color(factor)), progress, share,
                                                 lights_alone));
          },
          py::arg("earlier"), py::arg("scene"), py::arg("same_as"), py::arg("indirect"),
          py::arg("progress"), py::arg("share") = 1, py::arg("lights_alone") = false,
          "Returns the walls of another scene than the baked one, `earlier`. Direct light is\n"
          "exact. Other light, except the meshes' own emission, is scaled by (r, g, b).\n"
          "same_as: number of each mesh in the earlier scene, or -1. share: one of this many\n"
          "shadow rays is traced; lights_alone: true if only lights have moved, which is\n"
          "faster. Raises Cancelled.")
      .def("indirect", &indirect<D>, py::arg("mesh"), py::arg("back") = false,
           "Returns the radiance without direct light: float32 (nodes, m, 3) at the vertices of\n"
           "the coarse mesh.")
      .def("between", &between<D>, py::arg("mesh"),
           "Returns uint32 (n, 2): for each vertex, the two vertices of the coarse mesh that it\n"
           "lies halfway between.")
      .def("direct_ways", &direct_ways<D>, py::arg("mesh"),
           "Returns the shadow rays of a fine mesh, as five arrays. Each vertex has one of\n"
           "several sets of light points: its number, uint8 (n,). For each point, isosurfaces\n"
           "between the least and the greatest common isovalue block the ray, float32 (n,\n"
           "points) each; the least is None if isosurfaces are closed, and the greatest is\n"
           "infinite behind a mesh. Then the unshadowed irradiance over the amount of the point,\n"
           "negative on the back, float32 (n, points). Then, for front and back, the unshadowed\n"
           "radiance by all sets, float32 (lights + 1, n, 3), by each light of the scene and by\n"
           "all other emitters. A side reflects their sum times the share of light that no\n"
           "isosurface blocks, averaged over each vertex and its neighbors.")
      .def_property_readonly(
          "point_lights", &point_lights<D>,
          "int32 (points,): for each point of a set, the number of its light in the scene, or\n"
          "-1.")
      .def_property_readonly("point_amounts", &point_amounts<D>,
                             "float32 (sets, points, 3): linear RGB of the light points.");
}

}  // namespace

void bind_walls(py::module_& module) {
  bind_radiance<3>(module, "");
  bind_radiance<2>(module, "2");
}

}  // namespace leaflight::python

// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/lit_contour.h"

#include <tbb/parallel_for.h>

#include "leaflight/math/error.h"
#include "leaflight/surface/split_edges.h"

namespace leaflight {
namespace {

// Where more vertices are asked for.
constexpr int most_halvings = 2;

// What a cell's edges are cut for: texels at most so many voxels wide.
constexpr double narrow = 0.75;

// What the grid says at the vertices, written into the lists that are wished.
class Lookup {
 public:
  Lookup(const RadianceGrid<3>& grid, const Field<3>& field, const LitContourSettings& settings,
         std::size_t vertices, LitMesh& mesh)
      : grid_(grid), field_(field), settings_(settings), mesh_(mesh) {
    mesh.radiance.resize(settings.radiance ? vertices : 0);
    mesh.radiance_back.resize(settings.radiance_back ? vertices : 0);
  }
  bool wished() const { return settings_.radiance || settings_.radiance_back; }
  // Where there is but one level.
  void at(std::size_t first, const std::vector<Vec3>& positions) const {
    if (settings_.radiance) radiance_at(grid_, field_, positions, false, &mesh_.radiance[first]);
    if (settings_.radiance_back) {
      radiance_at(grid_, field_, positions, true, &mesh_.radiance_back[first]);
    }
  }
  void at(std::size_t vertex, const Vec3& index_position) const {
    if (settings_.radiance) {
      mesh_.radiance[vertex] = radiance_at(grid_, field_, index_position, false);
    }
    if (settings_.radiance_back) {
      mesh_.radiance_back[vertex] = radiance_at(grid_, field_, index_position, true);
    }
  }

 private:
  const RadianceGrid<3>& grid_;
  const Field<3>& field_;
  const LitContourSettings& settings_;
  LitMesh& mesh_;
};

// As fine as texels are everywhere, then as they are in places.
void split_as_texels(const RadianceGrid<3>& grid, const Field<3>& field, double isovalue,
                     std::size_t least_vertices, IsosurfaceMesh& mesh) {
  const auto split = [&](const std::function<bool(const Vec3&)>& wanted) {
    mesh = split_edges(field, isovalue, mesh, wanted);
  };
  const auto all = [](const Vec3&) { return true; };
  for (double width = grid.lattice.voxels_per_texel[0]; width < narrow; width *= 2) split(all);
  for (int i = 0; i < most_halvings && mesh.vertices.size() < least_vertices; ++i) split(all);
  for (int level = 1; level < grid.levels(); ++level) {
    split([&](const Vec3& middle) { return grid.level_at(middle) >= level; });
  }
}

}  // namespace

void lit_contour(const RadianceGrid<3>& grid, const Field<3>& field, double isovalue,
                 const LitContourSettings& settings, LitMesh& mesh) {
  if (settings.radiance_back && !grid.has_back()) {
    throw Error("This bake does not hold the inner side of its isosurfaces; bake both sides.");
  }
  const MarchingCubes cubes(field, isovalue);
  const bool as_it_is = grid.levels() == 1 && grid.lattice.voxels_per_texel[0] >= narrow &&
                        cubes.vertices() >= settings.least_vertices && !field.masked;
  if (as_it_is) {
    const Lookup look_up(grid, field, settings, cubes.vertices(), mesh);
    MarchingCubes::Visit visit;
    if (look_up.wished()) {
      visit = [&](std::size_t first, const std::vector<Vec3>& positions) {
        look_up.at(first, positions);
      };
    }
    cubes.fill(mesh, settings.normals, visit);
    return;
  }
  cubes.fill(mesh, settings.normals);
  if (field.masked) drop_unused_vertices(mesh);
  split_as_texels(grid, field, isovalue, settings.least_vertices, mesh);
  const Lookup look_up(grid, field, settings, mesh.vertices.size(), mesh);
  if (!look_up.wished()) return;
  tbb::parallel_for(std::size_t{0}, mesh.vertices.size(), [&](std::size_t v) {
    look_up.at(v, field.world_to_index.point(Vec3(mesh.vertices[v])));
  });
}

}  // namespace leaflight

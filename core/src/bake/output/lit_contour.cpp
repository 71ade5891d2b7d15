// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/output/lit_contour.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "surface/split_edges.h"

namespace leaflight {
namespace {

// Width of texels, in voxels, below which edges are split.
constexpr double narrow = 0.75;

// Meshes with fewer vertices are also split at steps of the light, this many times.
constexpr std::size_t small = 100'000;
constexpr int most_step_halvings = 2;

// The lookup of a grid's radiance at the vertices of a mesh.
class Lookup {
 public:
  Lookup(const ShownGrid<3>& grid, const Field<3>& field, const LitContourSettings& settings,
         LitMesh& mesh)
      : grid_(grid), field_(field), settings_(settings), mesh_(mesh) {}
  bool wished() const { return settings_.radiance || settings_.radiance_back; }
  bool cuts_steps() const { return wished() && std::isfinite(settings_.largest_step); }
  void resize(std::size_t vertices) const {
    mesh_.radiance.resize(settings_.radiance ? vertices : 0);
    mesh_.radiance_back.resize(settings_.radiance_back ? vertices : 0);
  }
  void at(std::size_t first, const std::vector<Vec3>& positions) const {
    if (settings_.radiance) radiance_at(grid_, field_, positions, false, &mesh_.radiance[first]);
    if (settings_.radiance_back) {
      radiance_at(grid_, field_, positions, true, &mesh_.radiance_back[first]);
    }
  }
  // Looks up all vertices of the mesh from number `first` on.
  void from(std::size_t first) const {
    resize(mesh_.vertices.size());
    if (!wished()) return;
    tbb::parallel_for(first, mesh_.vertices.size(), [&](std::size_t v) {
      const Vec3 position = field_.world_to_index.point(Vec3(mesh_.vertices[v]));
      if (settings_.radiance) mesh_.radiance[v] = radiance_at(grid_, field_, position, false);
      if (settings_.radiance_back) {
        mesh_.radiance_back[v] = radiance_at(grid_, field_, position, true);
      }
    });
  }
  // True if the light of two vertices differs by more than the largest step.
  bool steps(std::int32_t a, std::int32_t b) const {
    const auto step = [&](const std::vector<Vec<3, float>>& radiance) {
      if (radiance.empty()) return false;
      const Vec<3, float> difference = radiance[a] - radiance[b];
      return std::max({std::abs(difference.x), std::abs(difference.y), std::abs(difference.z)}) >
             settings_.largest_step;
    };
    return step(mesh_.radiance) || step(mesh_.radiance_back);
  }

 private:
  const ShownGrid<3>& grid_;
  const Field<3>& field_;
  const LitContourSettings& settings_;
  LitMesh& mesh_;
};

// Splits all edges to the width of the texels, then those across steps of the light.
void split_and_look_up(const RadianceGrid<3>& grid, const Field<3>& field, double isovalue,
                       const Lookup& look_up, LitMesh& mesh) {
  const auto split = [&](const std::function<bool(std::int32_t, std::int32_t)>& wanted) {
    static_cast<IsosurfaceMesh&>(mesh) = split_edges(field, isovalue, mesh, wanted);
  };
  for (double width = grid.lattice.voxels_per_texel[0]; width < narrow; width *= 2) {
    split([](std::int32_t, std::int32_t) { return true; });
  }
  look_up.from(0);
  for (int i = 0; i < most_step_halvings && look_up.cuts_steps() && mesh.vertices.size() < small;
       ++i) {
    const std::size_t before = mesh.vertices.size();
    split([&](std::int32_t a, std::int32_t b) { return look_up.steps(a, b); });
    look_up.from(before);
  }
}

}  // namespace

void lit_contour(const ShownGrid<3>& shown, const Field<3>& field, double isovalue,
                 const LitContourSettings& settings, LitMesh& mesh) {
  const RadianceGrid<3>& grid = shown.grid;
  if (settings.radiance) check_light(shown, false);
  if (settings.radiance_back) check_light(shown, true);
  const MarchingCubes cubes(field, isovalue);
  const Lookup look_up(shown, field, settings, mesh);
  mesh.contoured = cubes.triangles();
  const bool as_it_is = grid.lattice.voxels_per_texel[0] >= narrow &&
                        !(look_up.cuts_steps() && cubes.vertices() < small) && !field.masked;
  if (as_it_is) {
    look_up.resize(cubes.vertices());
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
  split_and_look_up(grid, field, isovalue, look_up, mesh);
}

}  // namespace leaflight

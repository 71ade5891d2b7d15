// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "bake/walls/mesh_neighbours.h"
#include "bake/walls/subdivided_mesh.h"
#include "math/progress.h"
#include "transport/light_points.h"

namespace leaflight {

// Direct light of a scene's light points at the vertices of its diffuse meshes. For each vertex and
// point it keeps which isosurfaces block the way, and so the shadow of every isosurface there.
// Neighbouring vertices use other sets of points, and the part of the light that reaches a vertex
// is the mean over it and its neighbours (interleaved sampling, Keller and Heidrich 2001): shadows
// are as smooth as by all sets, and their edges as wide as an edge of the mesh. The result is the
// same for any number of threads.
template <int D>
class MeshDirectLight {
 public:
  // One way of every `share` (at most light_point_sets) is traced for the shadow, and the others
  // are taken from neighbours, which trace them to their own points nearby: shadows are softer.
  // `earlier`: where lights alone were others, whose ways serve for the lights that have not
  // changed; it must not be scaled(). Throws Cancelled.
  MeshDirectLight(const SceneTracer<D>& tracer, const std::vector<SubdividedMesh<D>>& meshes,
                  Progress& progress, std::size_t share = 1,
                  const MeshDirectLight* earlier = nullptr);

  // With other strengths of the scene's lights: a factor per channel for each. Shares the ways.
  MeshDirectLight scaled(const std::vector<Rgb>& lights) const;

  // Radiance [W/(m^2 sr)] that one side of a mesh reflects at its fine vertices beside the
  // isosurface c.
  std::vector<Vec<3, float>> radiance(int mesh, double c, bool back) const;
  // The same if nothing stood in the way of the light.
  std::vector<Vec<3, float>> unshadowed(int mesh, bool back) const;
  // Its part by one of the scene's lights; the number behind the last one is all that is no light.
  std::vector<Vec<3, float>> unshadowed_by(std::size_t light, int mesh, bool back) const;
  std::size_t lights() const { return scales_.size(); }

  // From one vertex to one point of its set.
  struct Way {
    float greatest;  // the common isovalue; infinite where a mesh stands in the way
    // Irradiance over the point's amount if nothing did: positive on the mesh's front, negative on
    // its back.
    float share;
  };
  struct MeshWays {
    MeshNeighbours neighbours;
    std::vector<std::uint8_t> sets;  // of the vertices
    std::vector<Way> ways;           // [vertex * points + point]
    std::vector<float> least;  // as BlockingIsovalues has it; empty where nothing has openings
    // By side: radiance if nothing stood in the way of a light, by all sets; [light * vertices +
    // vertex], last of all that is no light.
    std::array<std::vector<Vec<3, float>>, 2> unshadowed;
  };
  const MeshWays& ways(int mesh) const { return (*meshes_)[mesh]; }
  const std::vector<std::vector<LightPoint<D>>>& sets() const { return sets_; }

 private:
  // An earlier mesh, whose ways serve for the lights that have not changed.
  struct Known {
    const MeshWays* ways = nullptr;
    std::size_t points = 0;                 // of each set then
    std::vector<std::vector<int>> numbers;  // by set: those of its points then, or -1
    std::vector<int> lights;                // by place_of(): that of the light then, or -1

    bool has(std::size_t light) const { return ways && lights[light] >= 0; }
  };
  Known known_of(const MeshDirectLight& earlier) const;
  // What is known of a vertex.
  void take(const Known& known, std::size_t vertex, MeshWays& to) const;
  // Of the light of a point; the last one is all that is no light.
  std::size_t place_of(const LightPoint<D>& point) const {
    return point.light < 0 ? lights() - 1 : static_cast<std::size_t>(point.light);
  }
  MeshWays ways_of(const SceneTracer<D>& tracer, const FineMesh<D>& mesh, Progress& progress,
                   std::size_t share, const Known& known) const;
  void take_from_neighbours(MeshWays& ways, std::size_t share, const Known& known) const;

  std::vector<std::vector<LightPoint<D>>> sets_;
  std::vector<Rgb> scales_;                              // of the lights, and 1
  std::shared_ptr<const std::vector<MeshWays>> meshes_;  // those of mirrors and glass are empty
};

// What its ways are for the progress, which it is given when they are traced: in points of lines.
template <int D>
double work_of_ways(const SceneTracer<D>& tracer, const std::vector<SubdividedMesh<D>>& meshes,
                    std::size_t share = 1);

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/bake/mesh_neighbours.h"
#include "leaflight/bake/refined_mesh.h"
#include "leaflight/math/progress.h"
#include "leaflight/transport/light_points.h"

namespace leaflight {

// Direct light of a scene's light points at the vertices of its diffuse meshes. For each vertex and
// point it keeps the greatest leaf coordinate on the way, which tells the shadow of every
// isosurface there. Neighbouring vertices use other sets of points, and the part of the light that
// reaches a vertex is the mean over it and its neighbours (interleaved sampling, Keller and
// Heidrich 2001): shadows are as smooth as by all sets, and their edges as wide as an edge of the
// mesh. The result is the same for any number of threads.
template <int D>
class MeshDirectLight {
 public:
  // Throws Cancelled.
  MeshDirectLight(const SceneTracer<D>& tracer, const std::vector<RefinedMesh<D>>& meshes,
                  Progress& progress);

  // Radiance [W/(m^2 sr)] that one side of a mesh reflects at its fine vertices beside the leaf c.
  std::vector<Vec<3, float>> radiance(int mesh, double c, bool back) const;

  // From one vertex to one point of its set.
  struct Way {
    float greatest;  // the leaf coordinate; infinite where a mesh stands in the way
    // Irradiance over the point's amount if nothing did: positive on the mesh's front, negative on
    // its back.
    float share;
  };
  struct MeshWays {
    MeshNeighbours neighbours;
    std::vector<std::uint8_t> sets;  // of the vertices
    std::vector<Way> ways;           // [vertex * points + point]
    // By side: radiance if nothing stood in the way of the light, by all sets.
    std::array<std::vector<Vec<3, float>>, 2> unshadowed;
  };
  const MeshWays& ways(int mesh) const { return meshes_[mesh]; }
  const std::vector<std::vector<LightPoint<D>>>& sets() const { return sets_; }

 private:
  MeshWays ways_of(const SceneTracer<D>& tracer, const FineMesh<D>& mesh, Progress& progress) const;

  std::vector<std::vector<LightPoint<D>>> sets_;
  std::vector<MeshWays> meshes_;  // those of mirrors and glass are empty
};

}  // namespace leaflight

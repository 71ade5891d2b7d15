// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "bake/plan/workers.h"
#include "bake/walls/mesh_neighbors.h"
#include "bake/walls/subdivided_mesh.h"
#include "base/progress.h"
#include "transport/light_points.h"

namespace leaflight {

// Direct light of a scene's light points at the vertices of its diffuse meshes. A shadow ray from
// each vertex to each point finds the isosurfaces that block it, which gives the shadow of every
// isosurface. Neighboring vertices use different sets of points. The shadow at a vertex is the mean
// over it and its neighbors (interleaved sampling, Keller and Heidrich 2001). Shadows are as smooth
// as with all sets, and their edges are as wide as an edge of the mesh. The result does not depend
// on the number of threads.
template <int D>
class MeshDirectLight {
 public:
  // Traces one of every `share` shadow rays, at most light_point_sets. Neighbors provide the
  // others, from their own nearby points, which makes shadows softer. An `earlier` light is that of
  // the same scene under other lights. Its shadow rays are reused for unchanged lights. It must not
  // be scaled(). Throws Cancelled.
  MeshDirectLight(const SceneTracer<D>& tracer, const std::vector<SubdividedMesh<D>>& meshes,
                  Progress& progress, std::size_t share = 1,
                  const MeshDirectLight* earlier = nullptr);

  // Returns the same light with one factor per channel for each light of the scene. Shares the
  // shadow rays.
  MeshDirectLight scaled(const std::vector<Rgb>& lights) const;

  // Returns the radiance [W/(m^2 sr)] that one side of a mesh reflects at its fine vertices, in the
  // presence of isosurface c.
  std::vector<Vec<3, float>> radiance(int mesh, double c, bool back) const;
  // Returns the same radiance without shadows.
  std::vector<Vec<3, float>> unshadowed(int mesh, bool back) const;
  // Returns the part of one light of the scene. The number after the last light is that of emissive
  // meshes and the environment.
  std::vector<Vec<3, float>> unshadowed_by(std::size_t light, int mesh, bool back) const;
  std::size_t lights() const { return scales_.size(); }

  // A traced shadow ray from a vertex to a point of its set.
  struct TracedRay {
    float greatest;  // common isovalue; infinite if a mesh blocks the ray
    // Unshadowed irradiance divided by the point's amount: positive on the mesh's front, negative
    // on its back.
    float share;
  };
  struct MeshRays {
    MeshNeighbors neighbors;
    std::vector<std::uint8_t> sets;  // one per vertex
    std::vector<TracedRay> rays;     // [vertex * points + point]
    std::vector<float> least;        // as in BlockingIsovalues; empty if nothing has openings
    // Unshadowed radiance by side, averaged over all sets; its index is light * vertices + vertex.
    // The last light is that of emissive meshes and the environment.
    std::array<std::vector<Vec<3, float>>, 2> unshadowed;
  };
  const MeshRays& rays(int mesh) const { return (*meshes_)[mesh]; }
  // Makes the light in parts (shadow_ray_parts.h): without rays, with the rays of all meshes, and
  // the rays of a mesh before and after they are traced from some vertices.
  explicit MeshDirectLight(const SceneTracer<D>& tracer);
  MeshDirectLight(const SceneTracer<D>& tracer, std::vector<MeshRays> traced);
  MeshRays opened(const SceneTracer<D>& tracer, const FineMesh<D>& mesh) const;
  void trace(const SceneTracer<D>& tracer, const FineMesh<D>& mesh, const BakePart& vertices,
             Progress& progress, MeshRays& traced) const;
  const std::vector<std::vector<LightPoint<D>>>& sets() const { return sets_; }

 private:
  // An earlier mesh whose shadow rays are reused for unchanged lights.
  struct Known {
    const MeshRays* rays = nullptr;
    std::size_t points = 0;                 // of each earlier set
    std::vector<std::vector<int>> numbers;  // by set: the earlier numbers of its points, or -1
    std::vector<int> lights;                // by place_of(): the earlier number of the light, or -1

    bool has(std::size_t light) const { return rays && lights[light] >= 0; }
  };
  Known known_of(const MeshDirectLight& earlier) const;
  // Copies the reusable shadow rays of a vertex.
  void take(const Known& known, std::size_t vertex, MeshRays& to) const;
  // Returns the place of a point's light; the last is that of emissive meshes and environments.
  std::size_t place_of(const LightPoint<D>& point) const {
    return point.light < 0 ? lights() - 1 : static_cast<std::size_t>(point.light);
  }
  MeshRays opened(const SceneTracer<D>& tracer, const FineMesh<D>& mesh, const Known& known) const;
  void trace_vertices(const SceneTracer<D>& tracer, const FineMesh<D>& mesh,
                      const BakePart& vertices, std::size_t share, const Known& known,
                      Progress& progress, MeshRays& traced) const;
  void trace_vertex(const SceneTracer<D>& tracer, const FineMesh<D>& mesh, std::size_t vertex,
                    std::size_t share, const Known& known, MeshRays& traced) const;
  MeshRays trace_mesh(const SceneTracer<D>& tracer, const FineMesh<D>& mesh, Progress& progress,
                      std::size_t share, const Known& known) const;
  void take_from_neighbors(MeshRays& traced, std::size_t share, const Known& known) const;

  std::vector<std::vector<LightPoint<D>>> sets_;
  std::vector<Rgb> scales_;                              // one per light, and 1
  std::shared_ptr<const std::vector<MeshRays>> meshes_;  // empty for mirrors and glass
};

// Returns the work of tracing the shadow rays, in points of lines.
template <int D>
double work_of_shadow_rays(const SceneTracer<D>& tracer,
                           const std::vector<SubdividedMesh<D>>& meshes, std::size_t share = 1);

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/plan/shared_parts.h"
#include "bake/walls/mesh_direct_light.h"

namespace leaflight {

// Traces parts of the shadow rays of MeshDirectLight. The inputs must outlive it.
template <int D>
class ShadowRayParts {
 public:
  ShadowRayParts(const SceneTracer<D>& tracer, const std::vector<SubdividedMesh<D>>& meshes);

  std::vector<BakePart> parts() const;
  // Traces a part and returns its rays as bytes.
  std::string traced(const BakePart& part, Progress& progress);
  // Makes the light from all parts().
  MeshDirectLight<D> light(const SharedParts& shared, Progress& progress);

 private:
  using MeshRays = typename MeshDirectLight<D>::MeshRays;

  bool is_diffuse(std::size_t mesh) const {
    return tracer_.meshes()[mesh].scattering == Scattering::diffuse;
  }
  // Calls body(items, count) for all arrays of the rays of a part's vertices.
  template <class Body>
  void for_each_array(MeshRays& traced, const BakePart& part, Body body) const;

  const SceneTracer<D>& tracer_;
  const std::vector<SubdividedMesh<D>>& meshes_;
  MeshDirectLight<D> light_;
  std::vector<MeshRays> rays_;  // of each mesh, once it is opened
};

}  // namespace leaflight

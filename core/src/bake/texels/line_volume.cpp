// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/texels/line_volume.h"

namespace leaflight {

template <int D>
bool meshes_near(const SceneTracer<D>& tracer, int volume, const Vec<D>* point) {
  Box<D> box = world_box(tracer.scene().volumes[volume].field);
  box = {tracer.frame().point(box.low), tracer.frame().point(box.high)};
  if (point) box.extend(*point);
  for (const Mesh<D>& mesh : tracer.meshes()) {
    for (const auto& facet : mesh.facets) {
      Box<D> facet_box;
      for (const std::uint32_t v : facet) facet_box.extend(Vec<D>(mesh.vertices[v]));
      if (facet_box.overlaps(box)) return true;
    }
  }
  return false;
}

template bool meshes_near<2>(const SceneTracer<2>&, int, const Vec<2>*);
template bool meshes_near<3>(const SceneTracer<3>&, int, const Vec<3>*);

}  // namespace leaflight

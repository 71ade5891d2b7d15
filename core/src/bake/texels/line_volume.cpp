// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/texels/line_volume.h"

#include "base/facet.h"

namespace leaflight {

namespace {

// True if all points lie on one side of the plane of a facet, not close to it.
template <int D>
bool on_one_side(const FacetFrame<D>& facet, const std::vector<Vec<D>>& points, double margin) {
  const Vec<D> normal = facet.normal();
  bool above = true, below = true;
  for (const Vec<D>& point : points) {
    const double height = normal.dot(point - facet.corner);
    above = above && height > margin;
    below = below && height < -margin;
  }
  return above || below;
}

}  // namespace

template <int D>
bool meshes_near(const SceneTracer<D>& tracer, int volume, const Vec<D>* point) {
  std::vector<Vec<D>> hull = world_corners(tracer.scene().volumes[volume].field);
  for (Vec<D>& corner : hull) corner = tracer.frame().point(corner);
  if (point) hull.push_back(*point);
  Box<D> box;
  for (const Vec<D>& corner : hull) box.extend(corner);
  const double margin = 1e-6 * box.longest_side();
  for (const Mesh<D>& mesh : tracer.meshes()) {
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
      Box<D> facet_box;
      for (const std::uint32_t v : mesh.facets[f]) facet_box.extend(Vec<D>(mesh.vertices[v]));
      if (facet_box.overlaps(box) && !on_one_side(FacetFrame<D>(mesh, f), hull, margin))
        return true;
    }
  }
  return false;
}

template bool meshes_near<2>(const SceneTracer<2>&, int, const Vec<2>*);
template bool meshes_near<3>(const SceneTracer<3>&, int, const Vec<3>*);

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/walls/shadow_ray_parts.h"

#include <algorithm>

namespace leaflight {
namespace {

constexpr std::size_t vertices_a_part = 2048;

}  // namespace

template <int D>
ShadowRayParts<D>::ShadowRayParts(const SceneTracer<D>& tracer,
                                  const std::vector<SubdividedMesh<D>>& meshes)
    : tracer_(tracer), meshes_(meshes), light_(tracer), rays_(meshes.size()) {}

template <int D>
std::vector<BakePart> ShadowRayParts<D>::parts() const {
  std::vector<BakePart> parts;
  for (std::size_t m = 0; m < meshes_.size(); ++m) {
    if (!is_diffuse(m)) continue;
    BakePart of_mesh{PartKind::shadows};
    of_mesh.mesh = static_cast<int>(m);
    add_parts(parts, of_mesh, meshes_[m].fine.vertices.size(), vertices_a_part);
  }
  return parts;
}

template <int D>
template <class Body>
void ShadowRayParts<D>::for_each_array(MeshRays& traced, const BakePart& part, Body body) const {
  const std::size_t points = light_.sets()[0].size(), vertices = traced.sets.size();
  const std::size_t count = part.end - part.begin;
  body(traced.rays.data() + part.begin * points, count * points);
  if (!traced.least.empty()) body(traced.least.data() + part.begin * points, count * points);
  for (auto& side : traced.unshadowed) {
    for (std::size_t light = 0; light < light_.lights(); ++light) {
      body(side.data() + light * vertices + part.begin, count);
    }
  }
}

template <int D>
std::string ShadowRayParts<D>::traced(const BakePart& part, Progress& progress) {
  const FineMesh<D>& mesh = meshes_[part.mesh].fine;
  MeshRays& rays = rays_[part.mesh];
  if (rays.sets.empty()) rays = light_.opened(tracer_, mesh);
  light_.trace(tracer_, mesh, part, progress, rays);
  std::string bytes;
  for_each_array(rays, part, [&](const auto* items, std::size_t count) {
    bytes.append(reinterpret_cast<const char*>(items), count * sizeof(*items));
  });
  return bytes;
}

template <int D>
MeshDirectLight<D> ShadowRayParts<D>::light(const SharedParts& shared, Progress& progress) {
  for (std::size_t m = 0; m < meshes_.size(); ++m) {
    if (is_diffuse(m)) rays_[m] = light_.opened(tracer_, meshes_[m].fine);
  }
  const double work =
      work_of_shadow_rays(tracer_, meshes_) / static_cast<double>(shared.parts().size());
  for (std::size_t i = 0; i < shared.parts().size(); ++i) {
    const BakePart& part = shared.parts()[i];
    const std::optional<std::string> bytes = shared.take(i, work, progress);
    if (!bytes) {
      traced(part, progress);
      continue;
    }
    std::size_t at = 0;
    for_each_array(rays_[part.mesh], part, [&](auto* items, std::size_t count) {
      copy_items(*bytes, at, items, count);
      at += count * sizeof(*items);
    });
  }
  return MeshDirectLight<D>(tracer_, std::move(rays_));
}

template class ShadowRayParts<2>;
template class ShadowRayParts<3>;

}  // namespace leaflight

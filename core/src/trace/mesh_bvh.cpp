// SPDX-License-Identifier: GPL-3.0-or-later
#include "trace/mesh_bvh.h"

#include <cstring>

#include "base/error.h"
#include "trace/embree_query.h"

namespace leaflight {
namespace {

Vec3 in_space(const Vec<2>& v) { return {v.x, v.y, 0}; }
Vec3 in_space(const Vec<3>& v) { return v; }

template <int D>
RTCRay make_ray(const Vec<D>& origin_d, const Vec<D>& direction_d, double t_max) {
  const Vec3 origin = in_space(origin_d), direction = in_space(direction_d);
  RTCRay ray{};
  ray.org_x = static_cast<float>(origin.x);
  ray.org_y = static_cast<float>(origin.y);
  ray.org_z = static_cast<float>(origin.z);
  ray.dir_x = static_cast<float>(direction.x);
  ray.dir_y = static_cast<float>(direction.y);
  ray.dir_z = static_cast<float>(direction.z);
  ray.tnear = 0;
  ray.tfar = static_cast<float>(t_max);
  ray.mask = ~0u;
  return ray;
}

// A geometry with its own vertex and index buffers; null without memory.
struct Buffers {
  RTCGeometry geometry;
  float* vertices;
  std::uint32_t* indices;
};

Buffers new_geometry(RTCDevice device, RTCGeometryType type, int corners, std::size_t vertices,
                     std::size_t facets) {
  RTCGeometry geometry = rtcNewGeometry(device, type);
  void* v = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                    3 * sizeof(float), vertices);
  void* i = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                    corners == 3 ? RTC_FORMAT_UINT3 : RTC_FORMAT_UINT4,
                                    corners * sizeof(std::uint32_t), facets);
  if (!v || !i) {
    rtcReleaseGeometry(geometry);
    return {nullptr, nullptr, nullptr};
  }
  return {geometry, static_cast<float*>(v), static_cast<std::uint32_t*>(i)};
}

RTCGeometry make_geometry(RTCDevice device, const Mesh<3>& mesh) {
  const Buffers buffers =
      new_geometry(device, RTC_GEOMETRY_TYPE_TRIANGLE, 3, mesh.vertices.size(), mesh.facets.size());
  if (!buffers.geometry) return nullptr;
  // Imath's vectors contain only numbers, although their constructors are not trivial.
  std::memcpy(buffers.vertices, mesh.vertices.data(),  // NOLINT(bugprone-undefined-memory-*)
              mesh.vertices.size() * 3 * sizeof(float));
  std::memcpy(buffers.indices, mesh.facets.data(), mesh.facets.size() * 3 * sizeof(std::uint32_t));
  return buffers.geometry;
}

// Makes a quad per segment. Vertex i becomes 2i below the plane and 2i + 1 above it; u runs along
// the segment.
RTCGeometry make_geometry(RTCDevice device, const Mesh<2>& mesh) {
  const Buffers buffers =
      new_geometry(device, RTC_GEOMETRY_TYPE_QUAD, 4, 2 * mesh.vertices.size(), mesh.facets.size());
  if (!buffers.geometry) return nullptr;
  float* vertex = buffers.vertices;
  for (const auto& v : mesh.vertices) {
    for (const float z : {-1.0f, 1.0f}) {
      *vertex++ = v.x;
      *vertex++ = v.y;
      *vertex++ = z;
    }
  }
  std::uint32_t* index = buffers.indices;
  for (const auto& [a, b] : mesh.facets) {
    for (const std::uint32_t i : {2 * a, 2 * b, 2 * b + 1, 2 * a + 1}) *index++ = i;
  }
  return buffers.geometry;
}

// Embree configuration for SSE2 instructions, which all processors have. Others change the last
// bits of hits, and later bounces amplify the difference.
constexpr const char* same_bits = "isa=sse2";

}  // namespace

template <int D>
struct MeshBvh<D>::Embree {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  ~Embree() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
};

template <int D>
MeshBvh<D>::MeshBvh(const std::vector<Mesh<D>>& meshes) {
  if (meshes.empty()) return;
  embree_ = std::make_unique<Embree>();
  embree_->device = rtcNewDevice(same_bits);
  if (!embree_->device) {
    throw Error("Embree could not start (error " + std::to_string(rtcGetDeviceError(nullptr)) +
                "); reinstall the Embree library.");
  }
  embree_->scene = rtcNewScene(embree_->device);
  rtcSetSceneFlags(embree_->scene, RTC_SCENE_FLAG_ROBUST);
  for (const Mesh<D>& mesh : meshes) {
    RTCGeometry geometry = make_geometry(embree_->device, mesh);
    if (!geometry) {
      throw Error("There is not enough memory for the mesh '" + mesh.name +
                  "'; use one with fewer faces.");
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(embree_->scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(embree_->scene);
}

template <int D>
MeshBvh<D>::~MeshBvh() = default;

template <int D>
std::optional<MeshHit> MeshBvh<D>::intersect(const Vec<D>& origin, const Vec<D>& direction,
                                             double t_max) const {
  if (!embree_) return std::nullopt;
  RTCRayHit query{};
  query.ray = make_ray<D>(origin, direction, t_max);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  intersect_one(embree_->scene, query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return MeshHit{query.ray.tfar, static_cast<int>(query.hit.geomID),
                 static_cast<int>(query.hit.primID), query.hit.u, D == 3 ? query.hit.v : 0};
}

template <int D>
bool MeshBvh<D>::occluded(const Vec<D>& origin, const Vec<D>& direction, double t_max) const {
  if (!embree_) return false;
  RTCRay ray = make_ray<D>(origin, direction, t_max);
  occluded_one(embree_->scene, ray);
  return ray.tfar < 0;
}

template class MeshBvh<2>;
template class MeshBvh<3>;

}  // namespace leaflight

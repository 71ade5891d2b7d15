// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/trace/surroundings.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <cstring>

#include "leaflight/math/error.h"

namespace leaflight {
namespace {

// The one difference between Embree 3 and 4 that concerns us: where the query context goes.
void intersect_one(RTCScene scene, RTCRayHit& query) {
#if RTC_VERSION_MAJOR >= 4
  rtcIntersect1(scene, &query);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &query);
#endif
}

void occluded_one(RTCScene scene, RTCRay& ray) {
#if RTC_VERSION_MAJOR >= 4
  rtcOccluded1(scene, &ray);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, &ray);
#endif
}

RTCRay make_ray(const Vec3& origin, const Vec3& direction, double t_max) {
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

}  // namespace

struct Surroundings::Embree {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  ~Embree() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
};

Surroundings::Surroundings(const std::vector<Mesh>& meshes) {
  if (meshes.empty()) return;
  embree_ = std::make_unique<Embree>();
  embree_->device = rtcNewDevice(nullptr);
  if (!embree_->device) {
    throw Error("Embree could not start (error " + std::to_string(rtcGetDeviceError(nullptr)) +
                "); reinstall the Embree library.");
  }
  embree_->scene = rtcNewScene(embree_->device);
  rtcSetSceneFlags(embree_->scene, RTC_SCENE_FLAG_ROBUST);
  for (const Mesh& mesh : meshes) {
    RTCGeometry geometry = rtcNewGeometry(embree_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                             3 * sizeof(float), mesh.vertices.size());
    void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              3 * sizeof(std::uint32_t), mesh.triangles.size());
    if (!vertices || !triangles) {
      rtcReleaseGeometry(geometry);
      throw Error("There is not enough memory for the mesh '" + mesh.name +
                  "'; use one with fewer faces.");
    }
    std::memcpy(vertices, mesh.vertices.data(), mesh.vertices.size() * 3 * sizeof(float));
    std::memcpy(triangles, mesh.triangles.data(),
                mesh.triangles.size() * 3 * sizeof(std::uint32_t));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(embree_->scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(embree_->scene);
}

Surroundings::~Surroundings() = default;

std::optional<SurroundingsHit> Surroundings::intersect(const Vec3& origin, const Vec3& direction,
                                                       double t_max) const {
  if (!embree_) return std::nullopt;
  RTCRayHit query{};
  query.ray = make_ray(origin, direction, t_max);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  intersect_one(embree_->scene, query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return SurroundingsHit{query.ray.tfar, static_cast<int>(query.hit.geomID),
                         static_cast<int>(query.hit.primID), query.hit.u, query.hit.v};
}

bool Surroundings::occluded(const Vec3& origin, const Vec3& direction, double t_max) const {
  if (!embree_) return false;
  RTCRay ray = make_ray(origin, direction, t_max);
  occluded_one(embree_->scene, ray);
  return ray.tfar < 0;
}

}  // namespace leaflight

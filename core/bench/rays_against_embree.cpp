// SPDX-License-Identifier: GPL-3.0-or-later
// Isosurface rays beside Embree on the contoured mesh, on one thread: what `validation/run bench
// rays` runs.
//
//     rays_against_embree FILE NX NY NZ RAYS REPETITIONS ISOVALUE...
//
// FILE: float32, x fastest. Prints a line of JSON for each isovalue: processor seconds of each
// repetition, which take turns, and hits.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

#include "base/random.h"
#include "surface/marching_cubes.h"
#include "trace/embree_query.h"
#include "trace/isosurface_ray.h"

namespace leaflight {
namespace {

// One ray for both methods. It leaves the front of an isosurface, with a cosine-weighted direction.
struct Pair {
  IsosurfaceRay<3> isosurface;
  RTCRay embree;
};

// Start of Embree's rays in voxels, because the mesh may lie this far from the isosurface.
constexpr double offset = 1e-3;

struct Mesh {
  RTCDevice device;
  RTCScene scene;

  explicit Mesh(const IsosurfaceMesh& surface)
      : device(rtcNewDevice("threads=1")), scene(rtcNewScene(device)) {
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    const std::size_t vertices = surface.vertices.size(), triangles = surface.triangles.size();
    void* v = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                      3 * sizeof(float), vertices);
    void* i = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                      3 * sizeof(std::uint32_t), triangles);
    std::memcpy(v, surface.vertices.data(), vertices * 3 * sizeof(float));
    std::memcpy(i, surface.triangles.data(), triangles * 3 * sizeof(std::uint32_t));
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
  }
  Mesh(const Mesh&) = delete;
  Mesh& operator=(const Mesh&) = delete;
  ~Mesh() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }

  bool intersect(const RTCRay& ray) const {
    RTCRayHit query{};
    query.ray = ray;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    intersect_one(scene, query);
    return query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
  }
  bool occluded(RTCRay ray) const {
    occluded_one(scene, ray);
    return ray.tfar < 0;
  }
};

Vec3 position(const IsosurfaceMesh& mesh, int vertex) {
  const auto& p = mesh.vertices[vertex];
  return {p[0], p[1], p[2]};
}

std::vector<Pair> rays_from(const Field<3>& field, const IsosurfaceMesh& mesh, double isovalue,
                            std::size_t count) {
  Random random(5);
  std::vector<Pair> rays;
  while (rays.size() < count) {
    const auto& triangle =
        mesh.triangles[static_cast<std::size_t>(random.uniform() * mesh.triangles.size())];
    double u = random.uniform(), v = random.uniform();
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Vec3 a = position(mesh, triangle[0]);
    const Vec3 on_mesh =
        a + (position(mesh, triangle[1]) - a) * u + (position(mesh, triangle[2]) - a) * v;
    // From the triangle to the isosurface by one step along the gradient.
    const CellPoint<3> near = locate(field, on_mesh);
    const CellCorners<3> corners = load_corners(field, near.cell);
    const Vec3 gradient = geometric_gradient(corners, near.local);
    const double step = (isovalue - interpolate(corners, near.local)) / gradient.dot(gradient);
    if (!(std::abs(step) * gradient.length() < 0.3)) continue;
    const Vec3 start = on_mesh + gradient * step;
    const Vec3 normal = gradient * (-1 / gradient.length());
    const double r = std::sqrt(random.uniform()), phi = 2 * M_PI * random.uniform();
    const Vec3 other = std::abs(normal.x) > 0.5 ? Vec3(0, 1, 0) : Vec3(1, 0, 0);
    const Vec3 x = normal.cross(other).normalized(), y = normal.cross(x);
    const Vec3 direction = x * (r * std::cos(phi)) + y * (r * std::sin(phi)) +
                           normal * std::sqrt(std::max(0.0, 1 - r * r));
    Pair ray;
    ray.isosurface.origin = locate(field, start);
    ray.isosurface.position = start;
    ray.isosurface.direction = direction;
    ray.isosurface.isovalue = isovalue;
    ray.isosurface.starts_on_isosurface = true;
    const Vec3 from = start + normal * offset;
    ray.embree = {};
    ray.embree.org_x = static_cast<float>(from.x);
    ray.embree.org_y = static_cast<float>(from.y);
    ray.embree.org_z = static_cast<float>(from.z);
    ray.embree.dir_x = static_cast<float>(direction.x);
    ray.embree.dir_y = static_cast<float>(direction.y);
    ray.embree.dir_z = static_cast<float>(direction.z);
    ray.embree.tnear = static_cast<float>(offset);
    ray.embree.tfar = std::numeric_limits<float>::infinity();
    ray.embree.mask = ~0u;
    rays.push_back(ray);
  }
  return rays;
}

struct Timed {
  const char* name;
  std::vector<double> seconds;
  std::size_t hits = 0;

  template <typename Answer>
  void run(const std::vector<Pair>& rays, const Answer& answer) {
    const std::clock_t start = std::clock();
    hits = 0;
    for (const Pair& ray : rays) hits += answer(ray);
    seconds.push_back(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
  }
  void print() const {
    std::printf(", \"%s\": {\"hits\": %zu, \"seconds\": [", name, hits);
    for (std::size_t i = 0; i < seconds.size(); ++i) {
      std::printf("%s%.9g", i ? ", " : "", seconds[i]);
    }
    std::printf("]}");
  }
};

void measure(const Field<3>& field, double isovalue, std::size_t count, int repetitions) {
  const IsosurfaceMesh surface = contour(field, isovalue);
  std::printf("{\"isovalue\": %.9g, \"triangles\": %zu", isovalue, surface.triangles.size());
  if (!surface.triangles.empty()) {
    const Mesh mesh(surface);
    const std::vector<Pair> rays = rays_from(field, surface, isovalue, count);
    Timed ours{"intersect", {}}, any{"occluded", {}};
    Timed embree{"embree_intersect", {}}, embree_any{"embree_occluded", {}};
    for (int i = 0; i < repetitions; ++i) {
      ours.run(rays,
               [&](const Pair& ray) { return intersect<3>(field, ray.isosurface).has_value(); });
      embree.run(rays, [&](const Pair& ray) { return mesh.intersect(ray.embree); });
      any.run(rays, [&](const Pair& ray) { return occluded<3>(field, ray.isosurface); });
      embree_any.run(rays, [&](const Pair& ray) { return mesh.occluded(ray.embree); });
    }
    for (const Timed* timed : {&ours, &embree, &any, &embree_any}) timed->print();
  }
  std::printf("}\n");
}

}  // namespace
}  // namespace leaflight

int main(int count, char** arguments) {
  using namespace leaflight;
  if (count < 8) {
    std::fprintf(stderr, "rays_against_embree: FILE NX NY NZ RAYS REPETITIONS ISOVALUE...\n");
    return 2;
  }
  const Index<3> dims{std::atoi(arguments[2]), std::atoi(arguments[3]), std::atoi(arguments[4])};
  std::vector<float> values(cell_count<3>(dims));
  std::ifstream file(arguments[1], std::ios::binary);
  const auto bytes = static_cast<std::streamsize>(values.size() * sizeof(float));
  if (!file.read(reinterpret_cast<char*>(values.data()), bytes)) {
    std::fprintf(stderr, "%s: it does not hold as many values.\n", arguments[1]);
    return 2;
  }
  Affine<3> voxels;
  for (int a = 0; a < 3; ++a) voxels.column[a] = Vec3(0.0), voxels.column[a][a] = 1;
  voxels.origin = Vec3(0.0);
  const Field<3> field = make_field<3>(values.data(), dims, voxels, nullptr);
  for (int i = 7; i < count; ++i) {
    measure(field, std::atof(arguments[i]), std::strtoull(arguments[5], nullptr, 10),
            std::atoi(arguments[6]));
  }
}

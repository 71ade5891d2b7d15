// SPDX-License-Identifier: GPL-3.0-or-later
// A volume of any values, its isosurface as a mesh and as rays hit it.
#include <map>

#include "hostile_field.h"
#include "one_thread.h"
#include "surface/marching_cubes.h"

namespace {

using namespace leaflight;

// Inside every vertex number, and no directed edge twice: the mesh is a manifold.
void check(const IsosurfaceMesh& mesh) {
  fuzz::require(fuzz::all_finite(mesh.vertices) && fuzz::all_finite(mesh.normals),
                "a vertex that is no number");
  std::map<std::pair<int, int>, int> sides;
  for (const auto& triangle : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      const int from = triangle[i], to = triangle[(i + 1) % 3];
      fuzz::require(from >= 0 && from < static_cast<int>(mesh.vertices.size()), "no such vertex");
      fuzz::require(++sides[{from, to}] == 1, "an edge runs the same way in two triangles");
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const fuzz::OneThread one_thread;
  fuzz::Bytes bytes(data, size);
  const double isovalue = bytes.take<float>();
  fuzz::accepted([&] {
    const Field<3> field = fuzz::hostile_field<3>(bytes);
    check(contour(field, isovalue));
    while (!bytes.empty()) fuzz::shoot(field, isovalue, bytes);
  });
  return 0;
}

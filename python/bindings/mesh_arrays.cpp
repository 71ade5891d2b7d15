// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_arrays.h"

namespace leaflight::python {

std::shared_ptr<LitMesh> mesh_to_fill() {
  static std::shared_ptr<LitMesh> last;
  if (last.use_count() != 1) last = std::make_shared<LitMesh>();
  return last;
}

py::tuple mesh_arrays(const std::shared_ptr<LitMesh>& mesh) {
  return py::make_tuple(rows_of<float>(mesh, mesh->vertices), rows_of<float>(mesh, mesh->normals),
                        rows_of<std::int32_t>(mesh, mesh->triangles));
}

}  // namespace leaflight::python

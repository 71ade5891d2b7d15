// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "arrays.h"
#include "bake/output/lit_contour.h"

namespace leaflight::python {

// Returns a mesh to fill. It is the previous mesh if Python has released all its arrays. Its memory
// is then not allocated and cleared at every change of the isovalue. Call it with the interpreter's
// lock.
std::shared_ptr<LitMesh> mesh_to_fill();

// Returns a list as an array of three columns, without a copy; None if it is empty but the mesh is
// not.
template <class Scalar, class Row>
py::object rows_of(const std::shared_ptr<LitMesh>& mesh, const std::vector<Row>& list) {
  static_assert(sizeof(Row) == 3 * sizeof(Scalar));
  if (list.empty() && !mesh->vertices.empty()) return py::none();
  auto owner = std::make_unique<std::shared_ptr<LitMesh>>(mesh);
  const py::capsule archive(owner.get(),
                            [](void* p) { delete static_cast<std::shared_ptr<LitMesh>*>(p); });
  owner.release();
  const std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(list.size()), 3};
  return py::array_t<Scalar>(shape, reinterpret_cast<const Scalar*>(list.data()), archive);
}

// Returns (vertices (n, 3), normals (n, 3) or None, triangles (m, 3)).
py::tuple mesh_arrays(const std::shared_ptr<LitMesh>& mesh);

}  // namespace leaflight::python

// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/field/field.h"

#include <limits>

#include "arrays.h"
#include "bindings.h"
#include "leaflight/field/bump_box.h"

namespace leaflight::python {
namespace {

Field<3> field_from(const FloatArray& values, const DoubleArray& index_to_world) {
  if (values.ndim() != 3) throw Error("The values of a field must be an array [z, y, x].");
  Index<3> dims;
  for (int a = 0; a < 3; ++a) {
    if (values.shape(2 - a) > std::numeric_limits<int>::max()) {
      throw Error("The volume is too large; crop or resample it.");
    }
    dims[a] = static_cast<int>(values.shape(2 - a));
  }
  // The array lives as long as the field; it must be released with the interpreter's lock held.
  std::shared_ptr<const void> owner(new FloatArray(values), [](const void* p) {
    const py::gil_scoped_acquire lock;
    delete static_cast<const FloatArray*>(p);
  });
  const float* data = values.data();
  const Affine<3> transform = to_affine(index_to_world);
  const py::gil_scoped_release unlocked;
  return make_field<3>(data, dims, transform, std::move(owner));
}

py::array_t<double> bounds(const Field<3>& field) {
  const WorldBox<3> box = world_box(field);
  py::array_t<double> result({2, 3});
  auto out = result.mutable_unchecked<2>();
  for (int a = 0; a < 3; ++a) {
    out(0, a) = box.low[a];
    out(1, a) = box.high[a];
  }
  return result;
}

py::array_t<float> sample(const Field<3>& field, const DoubleArray& array) {
  const std::vector<Vec3> points = to_points(array);
  std::vector<float> values;
  for (const Vec3& p : points) {
    const Vec3 index = field.world_to_index.point(p);
    if (!inside(field, index)) {
      values.push_back(std::numeric_limits<float>::quiet_NaN());
      continue;
    }
    const CellPoint<3> point = locate(field, index);
    values.push_back(static_cast<float>(interpolate(load_corners(field, point.cell), point.local)));
  }
  const auto n = static_cast<py::ssize_t>(values.size());
  return adopt<float>(std::move(values), {n});
}

}  // namespace

void bind_field(py::module_& module) {
  py::class_<Field<3>, std::shared_ptr<Field<3>>>(
      module, "Field",
      "A scalar volume with its transform to the world, checked and indexed for ray tracing.")
      .def(py::init([](const FloatArray& values, const DoubleArray& index_to_world) {
             return std::make_shared<Field<3>>(field_from(values, index_to_world));
           }),
           py::arg("values").noconvert(), py::arg("index_to_world"),
           "values: float32 [z, y, x], C-contiguous, kept by reference; NaN marks missing data.\n"
           "index_to_world: 4 x 4, maps (x, y, z) indices of voxels to world positions.\n"
           "Raises LeaflightError for constant, all-NaN or infinite values, fewer than two voxels\n"
           "along an axis, or a transform that cannot be inverted.")
      .def_readonly("dims", &Field<3>::dims, "Voxels along x, y, z.")
      .def_property_readonly(
          "range", [](const Field<3>& f) { return std::pair(f.min, f.max); },
          "Least and greatest value, in data units.")
      .def_readonly("masked", &Field<3>::masked, "Whether some voxels are NaN.")
      .def_property_readonly("values",
                             [](const std::shared_ptr<Field<3>>& f) {
                               return py::array_t<float>(shape_zyx(f->dims), f->values,
                                                         py::cast(f));
                             })
      .def_property_readonly("index_to_world",
                             [](const Field<3>& f) { return from_affine(f.index_to_world); })
      .def_property_readonly("bounds", &bounds, "World box of the voxels, (2, 3).")
      .def("sample", &sample, py::arg("points"),
           "Interpolated values (n,) at world points (n, 3); NaN outside and where masked.");

  module.def(
      "bump_box",
      [](int n) {
        std::vector<float> values;
        {
          const py::gil_scoped_release unlocked;
          values = bump_box<3>(n);
        }
        return adopt<float>(std::move(values), {n, n, n});
      },
      py::arg("n"),
      "The thesis's reference data set (Eq. 2.1, Table 2.1) as float32 [z, y, x], 0..255, on the\n"
      "unit cube with n voxels along each axis.");
}

}  // namespace leaflight::python

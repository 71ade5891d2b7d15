// SPDX-License-Identifier: GPL-3.0-or-later
#include "field/field.h"

#include <limits>

#include "arrays.h"
#include "bindings.h"
#include "field/bump_box.h"
#include "field/coarser_values.h"
#include "field/components.h"
#include "field/texel_lattice.h"

namespace leaflight::python {
namespace {

template <int D, class Value>
Field<D> field_from(const VoxelArray<Value>& values, const DoubleArray& index_to_world) {
  if (values.ndim() != D) {
    throw Error(D == 2 ? "The values of a field in the plane must be an array [y, x]."
                       : "The values of a field must be an array [z, y, x].");
  }
  Index<D> dims;
  for (int a = 0; a < D; ++a) {
    dims[a] = to_dim(values.shape(D - 1 - a));
  }
  std::shared_ptr<const void> owner = kept(values);
  const Value* data = values.data();
  const Affine<D> transform = to_affine<D>(index_to_world);
  const py::gil_scoped_release unlocked;
  return make_field<D>(data, dims, transform, std::move(owner));
}

template <int D>
void shade_by(Field<D>& field, const VoxelArray<float>& values) {
  if (std::vector<py::ssize_t>(values.shape(), values.shape() + values.ndim()) !=
      array_shape(field.dims)) {
    throw Error("There must be one shading value for each value of the field.");
  }
  field.shading_owner = kept(values);
  field.shading_values = values.data();
}

template <int D>
void cut_by(Field<D>& field, const VoxelArray<float>& ramp, double step) {
  if (std::vector<py::ssize_t>(ramp.shape(), ramp.shape() + ramp.ndim()) !=
      array_shape(field.dims)) {
    throw Error("There must be one value of the ramp for each value of the field.");
  }
  field.ramp_owner = kept(ramp);
  field.ramp = ramp.data();
  field.ramp_step = step;
}

template <int D>
py::array_t<double> bounds(const Field<D>& field) {
  const Box<D> box = world_box(field);
  py::array_t<double> result({2, D});
  auto out = result.mutable_unchecked<2>();
  for (int a = 0; a < D; ++a) {
    out(0, a) = box.low[a];
    out(1, a) = box.high[a];
  }
  return result;
}

template <int D>
py::array_t<float> sample(const Field<D>& field, const DoubleArray& array) {
  const std::vector<Vec<D>> points = to_points<D>(array);
  std::vector<float> values;
  for (const Vec<D>& p : points) {
    const Vec<D> index = field.world_to_index.point(p);
    if (!inside(field, index)) {
      values.push_back(std::numeric_limits<float>::quiet_NaN());
      continue;
    }
    const CellPoint<D> point = locate(field, index);
    values.push_back(static_cast<float>(interpolate(load_corners(field, point.cell), point.local)));
  }
  const auto n = static_cast<py::ssize_t>(values.size());
  return adopt<float>(std::move(values), {n});
}

template <int D>
using FieldClass = py::class_<Field<D>, std::shared_ptr<Field<D>>>;

template <int D, class Value>
void bind_voxels(FieldClass<D>& field) {
  field.def(py::init([](const VoxelArray<Value>& values, const DoubleArray& index_to_world) {
              return std::make_shared<Field<D>>(field_from<D, Value>(values, index_to_world));
            }),
            py::arg("values").noconvert(), py::arg("index_to_world"),
            "values: float32, uint8, int16 or uint16 [z, y, x], C-contiguous, kept by reference;\n"
            "NaN marks missing data.\n"
            "index_to_world: 4 x 4, maps (x, y, z) indices of voxels to world positions.\n"
            "In the plane [y, x] and 3 x 3.\n"
            "Raises LeaflightError for constant, all-NaN or infinite values, fewer than two "
            "voxels\nalong an axis, or a transform that cannot be inverted.");
}

template <int D>
void bind_cut(FieldClass<D>& field) {
  field
      .def("cut_by", &cut_by<D>, py::arg("ramp").noconvert(), py::arg("step"),
           "Makes normals and meshes flat at cuts. ramp: float32 [z, y, x], linear in the\n"
           "distance from the cut, at least the values of the field. step: Its difference a\n"
           "voxel. Call it before the field is part of a scene.")
      .def_property_readonly(
          "is_cut", [](const Field<D>& f) { return f.ramp != nullptr; }, "True after cut_by().");
}

template <int D>
void bind_field_of(py::module_& module, const char* name, const char* doc) {
  FieldClass<D> field(module, name, doc);
  bind_voxels<D, float>(field);
  bind_voxels<D, std::uint8_t>(field);
  bind_voxels<D, std::int16_t>(field);
  bind_voxels<D, std::uint16_t>(field);
  bind_cut<D>(field);
  field.def_readonly("dims", &Field<D>::dims, "Voxels along x, y, z.")
      .def_property_readonly(
          "range", [](const Field<D>& f) { return std::pair(f.min, f.max); },
          "Least and greatest value, in data units.")
      .def_readonly("masked", &Field<D>::masked, "True if some voxels are NaN.")
      .def_property_readonly("values",
                             [](const std::shared_ptr<Field<D>>& f) {
                               const auto array = [&](const auto* values) -> py::array {
                                 return py::array(array_shape(f->dims), values, py::cast(f));
                               };
                               return std::visit(array, f->values);
                             })
      .def("shade_by", &shade_by<D>, py::arg("values").noconvert(),
           "Uses other values, float32 [z, y, x], for the normals of isosurfaces, such as\n"
           "smoothed ones. They must be NaN at the same voxels. Call it before the field is part\n"
           "of a scene.")
      .def_property_readonly("index_to_world",
                             [](const Field<D>& f) { return from_affine(f.index_to_world); })
      .def(
          "placed",
          [](const Field<D>& f, const DoubleArray& index_to_world) {
            return std::make_shared<Field<D>>(placed(f, to_affine<D>(index_to_world)));
          },
          py::arg("index_to_world"),
          "Returns the field at another place. Both share their values and what was computed\n"
          "from them. Raises LeaflightError for a transform that cannot be inverted.")
      .def_property_readonly("bounds", &bounds<D>, "World box of the voxels, (2, D).")
      .def("sample", &sample<D>, py::arg("points"),
           "Returns interpolated values (n,) at world points (n, D); NaN outside and in masked\n"
           "cells.");
}

template <int D>
void bind_bump_box(py::module_& module, const char* name, const char* doc) {
  module.def(
      name,
      [](int n) {
        std::vector<float> values;
        {
          const py::gil_scoped_release unlocked;
          values = bump_box<D>(n);
        }
        return adopt<float>(std::move(values), std::vector<py::ssize_t>(D, n));
      },
      py::arg("n"), doc);
}

}  // namespace

void bind_field(py::module_& module) {
  bind_field_of<3>(module, "Field",
                   "A scalar volume with its transform to the world, checked and prepared for ray\n"
                   "tracing.");
  bind_field_of<2>(module, "Field2", "A scalar field in 2D.");
  bind_bump_box<3>(
      module, "bump_box",
      "Returns the thesis's reference data set (Eq. 2.1, Table 2.1) as float32 [z, y, x],\n"
      "0..255, on the unit cube with n voxels along each axis.");
  bind_bump_box<2>(module, "bump_box2", "Returns the same in 2D, float32 [y, x].");
  module.def(
      "coarser_values",
      [](const Field<3>& field) {
        std::vector<float> values;
        {
          const py::gil_scoped_release unlocked;
          values = coarser_values(field);
        }
        const Index<3> dims = coarser_resolution<3>(field.dims, 2);
        return adopt<float>(std::move(values), {dims[2], dims[1], dims[0]});
      },
      py::arg("field"),
      "Returns values at n // 2 + 1 nodes along each axis over the same domain, float32 [z,\n"
      "y, x]. Inside the border, each is a mean over about two voxels along each axis; NaN\n"
      "if one of them is.");
  module.def(
      "components",
      [](const Field<3>& field, float isovalue, Progress& progress) {
        Components found;
        {
          const py::gil_scoped_release unlocked;
          found = components(field, isovalue, progress);
        }
        const auto count = static_cast<py::ssize_t>(found.sizes.size());
        return py::make_tuple(
            adopt<std::uint32_t>(std::move(found.of_voxel), array_shape(field.dims)),
            adopt<std::uint64_t>(std::move(found.sizes), {count}));
      },
      py::arg("field"), py::arg("isovalue"), py::arg("progress"),
      "Returns (numbers, sizes) of the parts of the voxels at or above an isovalue that are\n"
      "connected across faces of voxels. numbers: uint32 [z, y, x], 0 below the isovalue, from 1\n"
      "on in descending order of size. sizes: voxels of each number, uint64. Raises Cancelled,\n"
      "and LeaflightError for more than 2^32 - 1 voxels.");
}

}  // namespace leaflight::python

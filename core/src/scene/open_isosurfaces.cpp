// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/open_isosurfaces.h"

namespace leaflight {

template <int D>
bool isosurfaces_are_open(const Volume<D>& volume, const IsovalueRange& isovalue_range) {
  const Field<D>& field = volume.field;
  if (field.masked) return true;
  for (int axis = 0; axis < D; ++axis) {
    for (const int end : {0, field.dims[axis] - 1}) {
      Index<D> low{}, high = field.dims;
      low[axis] = end;
      high[axis] = end + 1;
      bool reaches = false;
      for_each_index<D>(low, high, [&](const Index<D>& voxel) {
        reaches |= field.value(voxel) >= volume.isovalue(isovalue_range.min);
      });
      if (reaches) return true;
    }
  }
  return false;
}

template bool isosurfaces_are_open<2>(const Volume<2>&, const IsovalueRange&);
template bool isosurfaces_are_open<3>(const Volume<3>&, const IsovalueRange&);

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#include "field/coarser_values.h"

#include <tbb/parallel_for.h>

namespace leaflight {

std::vector<float> coarser_values(const Field<3>& field) {
  const Index<3> dims{field.dims[0] / 2, field.dims[1] / 2, field.dims[2] / 2};
  std::vector<float> values(cell_count<3>(dims));
  tbb::parallel_for(0, dims[2], [&](int z) {
    std::size_t block = linear_number<3>({0, 0, z}, dims);
    for (int y = 0; y < dims[1]; ++y) {
      for (int x = 0; x < dims[0]; ++x, ++block) {
        double sum = 0;
        for (const double h : load_corners(field, {2 * x, 2 * y, 2 * z}).h) sum += h;
        values[block] = static_cast<float>(sum / 8);
      }
    }
  });
  return values;
}

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
// As field.cpp, of an image.
#include "hostile_field.h"
#include "one_thread.h"
#include "surface/marching_squares.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace leaflight;
  static const fuzz::OneThread one_thread;
  fuzz::Bytes bytes(data, size);
  const double isovalue = bytes.take<float>();
  fuzz::accepted([&] {
    const Field<2> field = fuzz::hostile_field<2>(bytes);
    const IsolineMesh mesh = contour(field, isovalue);
    fuzz::require(fuzz::all_finite(mesh.vertices) && fuzz::all_finite(mesh.normals),
                  "a vertex that is no number");
    std::vector<int> out(mesh.vertices.size()), in(mesh.vertices.size());
    for (const auto& [from, to] : mesh.segments) {
      fuzz::require(++out.at(from) == 1 && ++in.at(to) == 1, "a line that forks");
    }
    while (!bytes.empty()) fuzz::shoot(field, isovalue, bytes);
  });
  return 0;
}

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

#include "bake/output/radiance_grid.h"
#include "surface/marching_cubes.h"

namespace leaflight {

// An isosurface's mesh, and what a bake says of it at its vertices.
struct LitMesh : IsosurfaceMesh {
  // [W/(m^2 sr)], of the front and the back; empty where not wished.
  std::vector<Vec<3, float>> radiance, radiance_back;
  std::size_t contoured = 0;  // triangles before edges were cut
};

struct LitContourSettings {
  bool normals = false;
  bool radiance = false, radiance_back = false;
  // Radiance [W/(m^2 sr)] that the ends of an edge may differ by. Others are cut in two, twice at
  // most, where the mesh is small: light is interpolated between vertices, and shadows are sharp.
  float largest_step = std::numeric_limits<float>::infinity();
};

// The contour of the volume that the grid lights, with edges cut in two as often as texels are
// narrower than voxels there, so that vertices show them. Uses the mesh's memory again. The result
// does not depend on the number of threads. Throws Error where the back was not baked.
void lit_contour(const ShownGrid<3>& shown, const Field<3>& field, double isovalue,
                 const LitContourSettings& settings, LitMesh& mesh);

}  // namespace leaflight

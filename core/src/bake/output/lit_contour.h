// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>

#include "bake/output/radiance_grid.h"
#include "surface/marching_cubes.h"

namespace leaflight {

// The mesh of an isosurface, with light of a bake at its vertices.
struct LitMesh : IsosurfaceMesh {
  // Radiance [W/(m^2 sr)] of the front and the back; empty if not requested.
  std::vector<Vec<3, float>> radiance, radiance_back;
  std::size_t contoured = 0;  // triangles before edges were split
};

struct LitContourSettings {
  bool normals = false;
  bool radiance = false, radiance_back = false;
  // Largest difference of radiance [W/(m^2 sr)] between the ends of an edge. Small meshes split
  // edges with larger differences, at most twice, because shadows are sharp.
  float largest_step = std::numeric_limits<float>::infinity();
};

// Contours the volume of the grid. Splits edges as often as texels are narrower than voxels, so
// that vertices can show their light. Reuses the mesh's memory. The result does not depend on the
// number of threads. Throws Error if the back is requested and was not baked.
void lit_contour(const ShownGrid<3>& shown, const Field<3>& field, double isovalue,
                 const LitContourSettings& settings, LitMesh& mesh);

}  // namespace leaflight

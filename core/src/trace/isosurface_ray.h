// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <optional>

#include "field/field.h"

namespace leaflight {

// A ray that hits only the isosurface of its isovalue (thesis Table 4.1), in index coordinates.
template <int D>
struct IsosurfaceRay {
  CellPoint<D> origin;  // ignored unless the ray starts on its isosurface
  Vec<D> position;      // index coordinates, anywhere
  Vec<D> direction;     // index coordinates per unit of t
  double isovalue = 0;
  double t_max = std::numeric_limits<double>::infinity();
  bool starts_on_isosurface = false;
  bool starts_above = false;  // side into which a ray that starts on its isosurface leaves
};

template <int D>
struct IsosurfaceHit {
  double t = 0;
  CellPoint<D> point;
  bool from_above = false;  // the ray arrived from the side h >= c, the back
};

// Returns the first point in (0, t_max] where the sign of h - c changes; h == c counts as above.
// Entering or leaving the domain or a masked cell is no hit.
template <int D>
std::optional<IsosurfaceHit<D>> intersect(const Field<D>& field, const IsosurfaceRay<D>& ray);

// True if there is such a point.
template <int D>
bool occluded(const Field<D>& field, const IsosurfaceRay<D>& ray);

}  // namespace leaflight

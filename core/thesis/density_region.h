// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace leaflight {

// The region over which photons are counted (thesis Fig. 4.4), in the coordinates (t, c): D - 1
// lengths tangent to the isosurface, and the isovalue. A search finds the photons within a ball of
// radius d of space x range under the metric |dx|^2 + (kappa dc)^2. The distance of isosurfaces is
// dc / |grad h|. So on flat isosurfaces the ball contains the ellipsoid
// |t|^2 + (kappa^2 + 1 / |grad h|^2) dc^2 <= d^2.
//   sphere          thesis Eq. 4.9, which assumes the ellipsoid |t|^2 + (kappa dc)^2 <= d^2. It is
//                   too large by sqrt(1 + 1 / q^2) with q = kappa |grad h|, so the estimate is too
//                   low.
//   clipped_sphere  thesis Eq. 4.10, divided by kappa: the sphere clipped at the lowest and highest
//                   isovalue found. This corrects for the ends of the range and part of the error
//                   above. Both are slightly inside the ball, which adds 1 % for 200 photons.
//   box, cylinder   photons inside the largest box of half sides a, a / kappa, or cylinder of
//                   radius r and half height r / kappa, in the ellipsoid; the others do not count.
//   graph           thesis 3.3.8: photons on the graph (x, kappa c) projected along c. It is the
//                   volume of the ellipsoid.
enum class DensityRegion { sphere, clipped_sphere, box, cylinder, graph };

// Returns the region of a name. Throws Error for an unknown name.
DensityRegion density_region_from(const std::string& name);

// Returns 4/3 pi d^3 / kappa, or pi d^2 / kappa in 2D.
template <int D>
double sphere_volume(double d, double kappa);

// Returns the volume between the isovalues low and high, relative to the center's isovalue.
template <int D>
double clipped_sphere_volume(double d, double kappa, double low, double high);

template <int D>
double graph_volume(double d, double kappa, double gradient_length);

// Returns the half side of the box; box_volume(): its volume.
template <int D>
double box_half_side(double d, double kappa, double gradient_length);
template <int D>
double box_volume(double half_side, double kappa);

// Returns the radius of the cylinder, a rectangle in 2D; cylinder_volume(): its volume.
template <int D>
double cylinder_radius(double d, double kappa, double gradient_length);
template <int D>
double cylinder_volume(double radius, double kappa);

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#include "thesis/density_region.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/sampling.h"

namespace leaflight {

DensityRegion density_region_from(const std::string& name) {
  if (name == "sphere") return DensityRegion::sphere;
  if (name == "clipped_sphere") return DensityRegion::clipped_sphere;
  if (name == "box") return DensityRegion::box;
  if (name == "cylinder") return DensityRegion::cylinder;
  if (name == "graph") return DensityRegion::graph;
  throw Error("There is no density region named '" + name +
              "'; choose sphere, clipped_sphere, box, cylinder or graph.");
}

template <int D>
double sphere_volume(double d, double kappa) {
  return (D == 3 ? 4.0 / 3 * pi * d * d * d : pi * d * d) / kappa;
}

template <int D>
double clipped_sphere_volume(double d, double kappa, double low, double high) {
  // Integrate up to the height t above the center: discs of radius sqrt(d^2 - t^2), in 2D chords.
  const auto below = [&](double c) {
    const double t = std::clamp(kappa * c, -d, d);
    if (D == 3) return pi * (d * d * t - t * t * t / 3);
    return t * std::sqrt(d * d - t * t) + d * d * std::asin(t / d);
  };
  return (below(high) - below(low)) / kappa;
}

template <int D>
double graph_volume(double d, double kappa, double gradient_length) {
  const double slope = kappa * gradient_length;
  return sphere_volume<D>(d, kappa) * slope / std::sqrt(1 + slope * slope);
}

template <int D>
double box_half_side(double d, double kappa, double gradient_length) {
  // A corner has D - 1 tangent lengths a, the height a, and the distance a / (kappa |grad h|) of
  // its isosurface.
  const double slope = kappa * gradient_length;
  return d / std::sqrt(D + 1 / (slope * slope));
}

template <int D>
double box_volume(double half_side, double kappa) {
  return std::pow(2 * half_side, D) / kappa;
}

template <int D>
double cylinder_radius(double d, double kappa, double gradient_length) {
  const double slope = kappa * gradient_length;
  return d / std::sqrt(2 + 1 / (slope * slope));
}

template <int D>
double cylinder_volume(double radius, double kappa) {
  return (D == 3 ? pi * radius * radius : 2 * radius) * 2 * radius / kappa;
}

template double sphere_volume<2>(double, double);
template double sphere_volume<3>(double, double);
template double clipped_sphere_volume<2>(double, double, double, double);
template double clipped_sphere_volume<3>(double, double, double, double);
template double graph_volume<2>(double, double, double);
template double graph_volume<3>(double, double, double);
template double box_half_side<2>(double, double, double);
template double box_half_side<3>(double, double, double);
template double box_volume<2>(double, double);
template double box_volume<3>(double, double);
template double cylinder_radius<2>(double, double, double);
template double cylinder_radius<3>(double, double, double);
template double cylinder_volume<2>(double, double);
template double cylinder_volume<3>(double, double);

}  // namespace leaflight

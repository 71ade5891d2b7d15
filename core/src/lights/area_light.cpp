// SPDX-License-Identifier: GPL-3.0-or-later
#include "lights/area_light.h"

#include <limits>

#include "base/bounds.h"
#include "lights/light_checks.h"

namespace leaflight {

template <int D>
Vec<D> AreaLight<D>::point(const std::array<double, 2>& u) const {
  std::array<double, 2> at = u;
  if (ellipse) {
    const Vec<2> disc = sample_disc(u);
    at = {0.5 + 0.5 * disc.x, 0.5 + 0.5 * disc.y};
  }
  Vec<D> p = corner;
  for (int i = 0; i < D - 1; ++i) p += edges[i] * at[i];
  return p;
}

template <int D>
double AreaLight<D>::area() const {
  return scaled_normal(edges).length() * (ellipse ? pi / 4 : 1);
}

template <int D>
void AreaLight<D>::check() const {
  const std::string light = "The light '" + name + "'";
  bool bounded = within_bounds(corner);
  for (const Vec<D>& edge : edges) bounded = bounded && within_bounds(edge);
  check_is_bounded(bounded, light);
  if (!(area() > 0)) throw Error(light + " has no area; give it a width and a height.");
  check_light_amount(radiance, light, "radiance");
}

template <int D>
std::vector<Vec<D>> AreaLight<D>::corners() const {
  std::vector<Vec<D>> points{corner};
  for (const Vec<D>& edge : edges) {
    for (std::size_t i = points.size(); i-- > 0;) points.push_back(points[i] + edge);
  }
  return points;
}

template <int D>
void AreaLight<D>::to_frame(const Vec<D>& center, double scale) {
  corner = (corner - center) * scale;
  for (Vec<D>& edge : edges) edge *= scale;
}

template <int D>
std::optional<Vec<D>> AreaLight<D>::place() const {
  return leave_plane<D>(point({0.5, 0.5}), normal());
}

template <int D>
double AreaLight<D>::power(const BoundingSphere<D>&) const {
  return projected_hemisphere<D> * area() * average(radiance);
}

// Returns the power of a diffuse emitter: pi A L (thesis Eq. 3.3), or 2 length L in the plane (Eq.
// 3.4).
template <int D>
double AreaLight<D>::largest_flux(const BoundingSphere<D>&) const {
  return largest(radiance * static_cast<Real>(projected_hemisphere<D> * area()));
}

template <int D>
double AreaLight<D>::near_irradiance() const {
  const Vec<D> middle = point({0.5, 0.5});
  return average(radiance) * area() / (spread<D>(middle.length()) + area());
}

template <int D>
LightSample<D> AreaLight<D>::sample(const Vec<D>& from, const std::array<double, 2>& u) const {
  LightSample<D> s;
  s.end = point(u);
  s.end_normal = normal();
  const Vec<D> to_light = s.end - from;
  const double distance = to_light.length();
  if (!(distance > 0)) return s;
  s.direction = to_light / distance;
  const double cosine = -s.direction.dot(s.end_normal);
  if (cosine > 0) {
    s.radiance = radiance * static_cast<Real>(cosine * area() / spread<D>(distance));
  }
  return s;
}

template <int D>
EmittedPhoton<D> AreaLight<D>::emit(const BoundingSphere<D>&,
                                    const std::array<double, 2>& u_position,
                                    const std::array<double, 2>& u_direction) const {
  const Vec<D> n = normal();
  return {leave_plane<D>(point(u_position), n), sample_cosine_hemisphere<D>(n, u_direction),
          radiance * static_cast<Real>(projected_hemisphere<D> * area())};
}

template <int D>
LightSource<D> AreaLight<D>::source(const std::array<double, 2>& u) const {
  LightSource<D> s;
  s.position = point(u);
  s.normal = normal();
  s.sphere = false;
  s.amount = radiance * static_cast<Real>(area());
  return s;
}

template <int D>
Rgb AreaLight<D>::radiance_along(const Vec<D>& origin, const Vec<D>& direction,
                                 double t_max) const {
  const Vec<D> n = normal();
  const double approach = -direction.dot(n);
  if (!(approach > 0)) return Rgb(0);
  const double t = (origin - corner).dot(n) / approach;
  // A light in the plane of a wall is in front of it.
  constexpr double slack = 64 * std::numeric_limits<float>::epsilon();
  if (!(t > 0 && (t - t_max) * approach < slack)) return Rgb(0);
  const Vec<D> at = origin + direction * t - corner;
  double radius2 = 0;
  for (const Vec<D>& edge : edges) {
    const double x = 2 * at.dot(edge) / edge.dot(edge) - 1;
    if (!(std::abs(x) <= 1)) return Rgb(0);
    radius2 += x * x;
  }
  return ellipse && radius2 > 1 ? Rgb(0) : radiance;
}

template <int D>
double AreaLight<D>::width() const {
  const double size = D == 3 ? std::sqrt(area()) : area();
  return size / std::max(point({0.5, 0.5}).length(), 1e-6);
}

template <int D>
double AreaLight<D>::aspect() const {
  return edges.front().length() / edges.back().length();
}

template struct AreaLight<2>;
template struct AreaLight<3>;

}  // namespace leaflight

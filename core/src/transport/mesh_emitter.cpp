// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/mesh_emitter.h"

#include <cmath>

namespace leaflight {

template <int D>
MeshEmitter<D>::MeshEmitter(const Mesh<D>& mesh) : mesh_(&mesh) {
  std::vector<double> areas;
  for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
    areas.push_back(FacetFrame<D>(mesh, f).area());
  }
  by_area_ = DiscreteDistribution(std::move(areas));
}

template <int D>
typename MeshEmitter<D>::PointOn MeshEmitter<D>::point(double choice,
                                                       const std::array<double, 2>& u) const {
  const FacetFrame<D> facet(*mesh_, by_area_.pick(choice).index);
  if constexpr (D == 2) return {facet.point(u[0], 0), facet.normal()};
  // Sample the triangle uniformly.
  const double root = std::sqrt(u[0]);
  return {facet.point(root * (1 - u[1]), root * u[1]), facet.normal()};
}

template <int D>
LightSample<D> MeshEmitter<D>::sample(const Vec<D>& from, double choice,
                                      const std::array<double, 2>& u) const {
  const PointOn on = point(choice, u);
  LightSample<D> s;
  const Vec<D> to_point = on.position - from;
  const double distance = to_point.length();
  if (!(distance > 0)) return s;
  s.direction = to_point / distance;
  const double cosine = -s.direction.dot(on.normal);
  s.end = on.position;
  s.end_normal = cosine < 0 ? -on.normal : on.normal;
  s.radiance = radiance() * static_cast<Real>(std::abs(cosine) * area() / spread<D>(distance));
  return s;
}

template <int D>
EmittedPhoton<D> MeshEmitter<D>::emit(double choice, const std::array<double, 2>& u_position,
                                      const std::array<double, 2>& u_direction) const {
  const bool front = choice < 0.5;
  const PointOn on = point(front ? 2 * choice : 2 * choice - 1, u_position);
  const Vec<D> normal = front ? on.normal : -on.normal;
  return {leave_plane<D>(on.position, normal), sample_cosine_hemisphere<D>(normal, u_direction),
          radiance() * static_cast<Real>(2 * projected_hemisphere<D> * area())};
}

template <int D>
LightSource<D> MeshEmitter<D>::source(double choice, const std::array<double, 2>& u) const {
  const PointOn on = point(choice, u);
  LightSource<D> s;
  s.position = on.position;
  s.normal = on.normal;
  s.sphere = false;
  s.both_sides = true;
  s.amount = radiance() * static_cast<Real>(area());
  return s;
}

template class MeshEmitter<2>;
template class MeshEmitter<3>;

}  // namespace leaflight

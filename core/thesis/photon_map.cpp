// SPDX-License-Identifier: GPL-3.0-or-later
#include "thesis/photon_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/error.h"

namespace leaflight {
namespace {

// True if a tangent offset is in the box, whose rotation about the normal is arbitrary.
bool within_box(const Vec<2>& tangent, const Vec<2>&, double half_side) {
  return tangent.length2() <= half_side * half_side;
}
bool within_box(const Vec3& tangent, const Vec3& normal, double half_side) {
  const Vec3 axis = std::abs(normal.x) < 0.6 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
  const Vec3 u = normal.cross(axis).normalized();
  return std::abs(tangent.dot(u)) <= half_side &&
         std::abs(tangent.dot(normal.cross(u))) <= half_side;
}

}  // namespace

void validate(const PhotonMapSettings& settings) {
  if (!(settings.k >= 2 && settings.k <= (1 << 20))) {
    throw Error("The photon map gathers " + std::to_string(settings.k) +
                " photons per estimate; choose between 2 and 1048576.");
  }
  if (!(settings.radius >= 0 && std::isfinite(settings.radius))) {
    throw Error("The photon map's search radius is " + std::to_string(settings.radius) +
                "; choose a positive one, or 0 for none.");
  }
  if (!(settings.g > 0 && std::isfinite(settings.g))) {
    throw Error("The photon map's g, the weight of the range, is " + std::to_string(settings.g) +
                "; choose a positive one, such as 10.");
  }
}

template <int D>
PhotonMap<D>::PhotonMap(std::vector<StoredPhoton<D>> photons, double domain_extent,
                        double range_extent, const PhotonMapSettings& settings, double height)
    : photons_(std::move(photons)),
      settings_(settings),
      kappa_(settings.g * domain_extent / range_extent),
      height_(height) {
  validate(settings);
  if (photons_.size() > std::numeric_limits<std::uint32_t>::max()) {
    throw Error("The photon map would hold " + std::to_string(photons_.size()) +
                " photons, too many to number; trace fewer.");
  }
  if (!photons_.empty()) {
    lowest_ = std::min_element(photons_.begin(), photons_.end(), [](const auto& a, const auto& b) {
                return a.c < b.c;
              })->c;
  }
  for (const bool back : {false, true}) sides_.push_back(make_side(back));
}

template <int D>
typename PhotonMap<D>::Side PhotonMap<D>::make_side(bool back) const {
  std::vector<std::uint32_t> numbers;
  std::vector<typename KdTree<D + 1>::Point> points;
  for (std::size_t i = 0; i < photons_.size(); ++i) {
    const StoredPhoton<D>& photon = photons_[i];
    if (photon.back != back || (photon.direct && !settings_.direct)) continue;
    numbers.push_back(static_cast<std::uint32_t>(i));
    typename KdTree<D + 1>::Point point;
    for (int a = 0; a < D; ++a) point[a] = photon.position[a];
    point[D] = static_cast<float>(kappa_ * (photon.c - lowest_));
    points.push_back(point);
  }
  return {std::move(numbers), KdTree<D + 1>(std::move(points))};
}

template <int D>
Rgb PhotonMap<D>::irradiance(const Vec<D>& position, double c, bool back,
                             const Vec<D>& gradient) const {
  const Side& side = sides_[back];
  typename KdTree<D + 1>::Query query;
  for (int a = 0; a < D; ++a) query[a] = position[a];
  query[D] = kappa_ * (c - lowest_);
  const double limit2 = settings_.radius > 0 ? settings_.radius * settings_.radius
                                             : std::numeric_limits<double>::infinity();
  std::vector<Neighbor> found;
  found.reserve(settings_.k);
  side.tree.nearest(query, settings_.k, limit2, found);
  if (found.empty()) return Rgb(0);
  // Start with the search's own limit, for searches with too few results to reach it.
  double d2 = limit2;
  if (static_cast<int>(found.size()) == settings_.k ||
      !(d2 < std::numeric_limits<double>::infinity())) {
    d2 = 0;
    for (const Neighbor& n : found) d2 = std::max(d2, n.distance2);
  }
  std::vector<const StoredPhoton<D>*> photons;
  photons.reserve(found.size());
  for (const Neighbor& n : found) photons.push_back(&photons_[side.photon[n.number]]);
  const Region region = region_around(photons, position, c, gradient, std::sqrt(d2));
  return region.volume > 0 ? Rgb(region.flux_height * (height_ / region.volume)) : Rgb(0);
}

template <int D>
typename PhotonMap<D>::Region PhotonMap<D>::region_around(
    const std::vector<const StoredPhoton<D>*>& photons, const Vec<D>& position, double c,
    const Vec<D>& gradient, double d) const {
  const double gradient_length = gradient.length();
  const auto all = [&](double volume) {
    Region region{volume};
    for (const auto* photon : photons) region.flux_height += Imath::V3d(photon->flux_height);
    return region;
  };
  // Counts photons whose offset along the isosurface and in the isovalue, scaled by kappa, is
  // accepted. An offset without its part between the isosurfaces keeps its length along them. A
  // projection onto the tangent plane would be shorter on curved isosurfaces, and count too many
  // photons. On a sphere of radius 0.3 lit by 55,000 photons, the result would be 5 % too high.
  const auto accepted = [&](double volume, auto accepts) {
    Region region{volume};
    if (!(gradient_length > 0)) return region;
    const Vec<D> normal = gradient / gradient_length;
    for (const auto* photon : photons) {
      const Vec<D> offset = Vec<D>(photon->position) - position;
      const double height = photon->c - c, apart = height / gradient_length;
      const double length = std::sqrt(std::max(0.0, offset.length2() - apart * apart));
      const Vec<D> tangent = (offset - normal * normal.dot(offset)).normalized() * length;
      if (!accepts(tangent, normal, kappa_ * std::abs(height))) continue;
      region.flux_height += Imath::V3d(photon->flux_height);
    }
    return region;
  };
  switch (settings_.region) {
    case DensityRegion::sphere:
      return all(sphere_volume<D>(d, kappa_));
    case DensityRegion::clipped_sphere: {
      const auto [low, high] = std::minmax_element(
          photons.begin(), photons.end(), [](const auto* a, const auto* b) { return a->c < b->c; });
      return all(clipped_sphere_volume<D>(d, kappa_, (*low)->c - c, (*high)->c - c));
    }
    case DensityRegion::box: {
      const double half = box_half_side<D>(d, kappa_, gradient_length);
      return accepted(box_volume<D>(half, kappa_),
                      [&](const Vec<D>& tangent, const Vec<D>& normal, double height) {
                        return height <= half && within_box(tangent, normal, half);
                      });
    }
    case DensityRegion::cylinder: {
      const double radius = cylinder_radius<D>(d, kappa_, gradient_length);
      return accepted(cylinder_volume<D>(radius, kappa_),
                      [&](const Vec<D>& tangent, const Vec<D>&, double height) {
                        return height <= radius && tangent.length2() <= radius * radius;
                      });
    }
    case DensityRegion::graph:
      break;
  }
  return all(graph_volume<D>(d, kappa_, gradient_length));
}

template class PhotonMap<2>;
template class PhotonMap<3>;

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "thesis/density_region.h"
#include "thesis/kd_tree.h"
#include "transport/stored_photons.h"

namespace leaflight {

struct PhotonMapSettings {
  int k = 200;        // photons per estimate
  double radius = 0;  // upper bound of the search, in the frame; 0: none
  double g = 10;      // weight of the range's extent relative to the domain's
  DensityRegion region = DensityRegion::clipped_sphere;
  bool direct = false;  // also counts photons that come straight from a light
};

// Throws Error for invalid numbers.
void validate(const PhotonMapSettings& settings);

// The thesis's estimator (4.3.5), the baseline of all comparisons. Photons at (x, c) are in a
// kd-tree of D + 1 dimensions. E = sum of F_p / dV (Eq. 4.8) over the k nearest photons by
// |dx|^2 + (kappa dc)^2, with kappa = g * extent of the domain / extent of the range.
//
// All k photons count, as in Jensen's photon map, although the last one is on the border of the
// region. So spheres and graph are too high by 1 / (k - 1). Box and cylinder exclude the last
// photon and avoid this bias.
template <int D>
class PhotonMap {
 public:
  // Makes a map of one volume's photons. `domain_extent`: longest side of its box in the frame.
  // `range_extent`: extent of its data in common isovalues. `height`: unit of flux-heights.
  PhotonMap(std::vector<StoredPhoton<D>> photons, double domain_extent, double range_extent,
            const PhotonMapSettings& settings, double height = 1);

  // Returns the irradiance at a point on the front or back of the isosurface, from photons of that
  // side. The `gradient` is that of c in the frame, of either sign; the spheres ignore it.
  Rgb irradiance(const Vec<D>& position, double c, bool back, const Vec<D>& gradient) const;

  std::size_t size() const { return photons_.size(); }
  const std::vector<StoredPhoton<D>>& photons() const { return photons_; }
  const PhotonMapSettings& settings() const { return settings_; }
  double kappa() const { return kappa_; }

 private:
  // The photons that count on one side of the isosurfaces.
  struct Side {
    std::vector<std::uint32_t> photon;  // one per point of the tree
    KdTree<D + 1> tree;
  };
  Side make_side(bool back) const;
  // The volume dV of a region, and the sum of the fluxes in it.
  struct Region {
    double volume;
    Imath::V3d flux_height{0};
  };
  // Returns the region of the nearest photons. `d`: distance of the farthest.
  Region region_around(const std::vector<const StoredPhoton<D>*>& photons, const Vec<D>& position,
                       double c, const Vec<D>& gradient, double d) const;

  std::vector<StoredPhoton<D>> photons_;
  PhotonMapSettings settings_;
  double kappa_, height_;
  double lowest_ = 0;  // of c; the tree's last coordinate is kappa (c - lowest)
  std::vector<Side> sides_;
};

}  // namespace leaflight

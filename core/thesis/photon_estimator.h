// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "transport/indirect_estimator.h"

namespace leaflight {

// A texel on one side of a volume's isosurfaces.
template <int D>
struct IsosurfaceTexel {
  int volume;
  bool back;
  Vec<D> center;  // index position
  Rgb albedo;
};

// An estimator that uses the photon density at the point, without rays. All samples of a point are
// equal.
template <int D>
class PhotonEstimator : public IndirectEstimator<D> {
 public:
  // Returns the variance that all samples of a texel share, averaged over the channels. It is the
  // variance of the photon density. `radiance`: mean of all samples.
  virtual float shared_variance(const IsosurfaceTexel<D>& texel, const Rgb& radiance) const = 0;
};

// Makes an estimator that uses Eq. E(R) of IsosurfaceCache. `walls` is null if no point is on a
// wall.
template <int D>
std::unique_ptr<PhotonEstimator<D>> make_volumetric_estimator(
    const std::vector<IsosurfaceRadiance<D>>& isosurfaces, const SurfaceCache<D>* walls);

// Returns the variance that all caustics of a texel share.
template <int D>
float caustic_variance(const std::vector<IsosurfaceRadiance<D>>& isosurfaces,
                       const IsosurfaceTexel<D>& texel);

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/transport/thesis_estimator.h"

#include "leaflight/math/sampling.h"

namespace leaflight {
namespace {

template <int D>
class ThesisEstimator final : public IndirectEstimator<D> {
 public:
  explicit ThesisEstimator(const PhotonMap<D>& photons) : photons_(photons) {}

  Rgb indirect_radiance(const SurfacePoint<D>& point, const std::array<double, 2>&, Random&,
                        std::uint64_t&) const override {
    const Rgb irradiance = photons_.irradiance(point.position, point.isovalue, point.above,
                                               point.geometric_normal * point.gradient_length);
    return irradiance * point.albedo / static_cast<Real>(projected_hemisphere<D>);
  }

 private:
  const PhotonMap<D>& photons_;
};

}  // namespace

template <int D>
std::unique_ptr<IndirectEstimator<D>> make_thesis_estimator(const PhotonMap<D>& photons) {
  return std::make_unique<ThesisEstimator<D>>(photons);
}

template std::unique_ptr<IndirectEstimator<2>> make_thesis_estimator(const PhotonMap<2>&);
template std::unique_ptr<IndirectEstimator<3>> make_thesis_estimator(const PhotonMap<3>&);

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#include "thesis/photon_estimator.h"

#include "base/sampling.h"

namespace leaflight {
namespace {

// Returns the variance of the radiance that the photon density of a texel gives.
template <int D>
float density_variance(const std::vector<IsosurfaceRadiance<D>>& isosurfaces,
                       const IsosurfaceTexel<D>& texel,
                       float (IsosurfaceCache<D>::*variance)(std::int32_t, bool) const) {
  const IsosurfaceRadiance<D>& isosurface = isosurfaces[texel.volume];
  const std::int32_t slot = isosurface.lattice->nearest_slot(texel.center);
  if (!isosurface.photons || slot == TexelLattice<D>::inactive) return 0;
  const auto brdf = static_cast<float>(average(texel.albedo) / projected_hemisphere<D>);
  return brdf * brdf * (isosurface.photons->*variance)(slot, texel.back);
}

template <int D>
class VolumetricEstimator final : public PhotonEstimator<D> {
 public:
  VolumetricEstimator(const std::vector<IsosurfaceRadiance<D>>& isosurfaces,
                      const SurfaceCache<D>* walls)
      : isosurfaces_(isosurfaces), walls_(walls) {}

  Rgb indirect_radiance(const SurfacePoint<D>& point, const std::array<double, 2>&, Random&,
                        std::uint64_t&) const override {
    const Rgb brdf = point.albedo / static_cast<Real>(projected_hemisphere<D>);
    if (point.kind() == HitKind::mesh) return brdf * walls_->indirect_irradiance(point);
    const IsosurfaceRadiance<D>& isosurface = isosurfaces_[point.isosurface().volume];
    const std::int32_t slot =
        isosurface.lattice->nearest_slot(point.isosurface().cell_point.index_position());
    if (slot == TexelLattice<D>::inactive) return Rgb(0);
    return brdf * isosurface.photons->indirect(slot, point.isosurface().back);
  }
  float shared_variance(const IsosurfaceTexel<D>& texel, const Rgb&) const override {
    return density_variance<D>(isosurfaces_, texel, &IsosurfaceCache<D>::indirect_variance);
  }

 private:
  const std::vector<IsosurfaceRadiance<D>>& isosurfaces_;
  const SurfaceCache<D>* walls_;
};

}  // namespace

template <int D>
std::unique_ptr<PhotonEstimator<D>> make_volumetric_estimator(
    const std::vector<IsosurfaceRadiance<D>>& isosurfaces, const SurfaceCache<D>* walls) {
  return std::make_unique<VolumetricEstimator<D>>(isosurfaces, walls);
}

template <int D>
float caustic_variance(const std::vector<IsosurfaceRadiance<D>>& isosurfaces,
                       const IsosurfaceTexel<D>& texel) {
  return density_variance<D>(isosurfaces, texel, &IsosurfaceCache<D>::caustic_variance);
}

template std::unique_ptr<PhotonEstimator<2>> make_volumetric_estimator(
    const std::vector<IsosurfaceRadiance<2>>&, const SurfaceCache<2>*);
template std::unique_ptr<PhotonEstimator<3>> make_volumetric_estimator(
    const std::vector<IsosurfaceRadiance<3>>&, const SurfaceCache<3>*);
template float caustic_variance(const std::vector<IsosurfaceRadiance<2>>&,
                                const IsosurfaceTexel<2>&);
template float caustic_variance(const std::vector<IsosurfaceRadiance<3>>&,
                                const IsosurfaceTexel<3>&);

}  // namespace leaflight

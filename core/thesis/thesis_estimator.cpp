// SPDX-License-Identifier: GPL-3.0-or-later
#include "thesis/thesis_estimator.h"

#include "base/sampling.h"

namespace leaflight {
namespace {

template <int D>
class ThesisEstimator final : public PhotonEstimator<D> {
 public:
  ThesisEstimator(std::vector<PhotonMap<D>> photons, const SurfaceCache<D>* walls)
      : photons_(std::move(photons)), walls_(walls) {}

  Rgb indirect_radiance(const SurfacePoint<D>& point, const std::array<double, 2>&, Random&,
                        std::uint64_t&) const override {
    const Rgb brdf = point.albedo / static_cast<Real>(projected_hemisphere<D>);
    if (point.kind() == HitKind::mesh) return brdf * walls_->indirect_irradiance(point);
    const IsosurfacePlace<D>& isosurface = point.isosurface();
    return brdf * photons_[isosurface.volume].irradiance(
                      point.position, point.c, isosurface.back,
                      point.geometric_normal * isosurface.gradient_length);
  }
  float shared_variance(const IsosurfaceTexel<D>& texel, const Rgb& radiance) const override {
    const double mean = average(radiance);
    return static_cast<float>(mean * mean / photons_[texel.volume].settings().k);
  }

 private:
  std::vector<PhotonMap<D>> photons_;
  const SurfaceCache<D>* walls_;
};

}  // namespace

template <int D>
std::vector<PhotonMap<D>> make_photon_maps(const SceneTracer<D>& tracer,
                                           const std::vector<StoredPhoton<D>>& photons,
                                           const PhotonMapSettings& settings) {
  std::vector<PhotonMap<D>> maps;
  const auto& volumes = tracer.scene().volumes;
  for (std::size_t v = 0; v < volumes.size(); ++v) {
    std::vector<StoredPhoton<D>> volume_photons;
    for (const StoredPhoton<D>& photon : photons) {
      if (photon.volume == static_cast<int>(v)) volume_photons.push_back(photon);
    }
    const Field<D>& field = volumes[v].field;
    const double side = world_box(field).longest_side();
    const double range = (static_cast<double>(field.max) - field.min) / volumes[v].scale;
    maps.emplace_back(std::move(volume_photons), side * tracer.frame().scale, range, settings,
                      tracer.scene().isovalue_range.height());
  }
  return maps;
}

template <int D>
std::unique_ptr<PhotonEstimator<D>> make_thesis_estimator(std::vector<PhotonMap<D>> photons,
                                                          const SurfaceCache<D>* walls) {
  return std::make_unique<ThesisEstimator<D>>(std::move(photons), walls);
}

template std::vector<PhotonMap<2>> make_photon_maps(const SceneTracer<2>&,
                                                    const std::vector<StoredPhoton<2>>&,
                                                    const PhotonMapSettings&);
template std::vector<PhotonMap<3>> make_photon_maps(const SceneTracer<3>&,
                                                    const std::vector<StoredPhoton<3>>&,
                                                    const PhotonMapSettings&);
template std::unique_ptr<PhotonEstimator<2>> make_thesis_estimator(std::vector<PhotonMap<2>>,
                                                                   const SurfaceCache<2>*);
template std::unique_ptr<PhotonEstimator<3>> make_thesis_estimator(std::vector<PhotonMap<3>>,
                                                                   const SurfaceCache<3>*);

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/transport/indirect_estimator.h"

#include "leaflight/math/sampling.h"

namespace leaflight {
namespace {

// Light from below the traced surface does not arrive, whatever the shading normal says.
template <int D>
bool leaves_surface(const SurfacePoint<D>& point, const Vec<D>& direction) {
  return direction.dot(point.geometric_normal) > 0;
}

template <int D>
class PathEstimator final : public IndirectEstimator<D> {
 public:
  PathEstimator(const SceneTracer<D>& tracer, const LightSampler<D>& lights)
      : tracer_(tracer), lights_(lights) {}

  Rgb indirect_radiance(const SurfacePoint<D>& start, const std::array<double, 2>& u,
                        Random& random, std::uint64_t& rays) const override {
    SurfacePoint<D> point = start;
    std::array<double, 2> sample = u;
    Rgb radiance(0), throughput(1);
    for (;;) {
      throughput *= point.albedo;
      const Real survival = std::min(Real(1), largest(throughput));
      if (!(random.uniform() < survival)) return radiance;
      throughput /= survival;
      const Vec<D> direction = sample_cosine_hemisphere<D>(point.shading_normal, sample);
      if (!leaves_surface(point, direction)) return radiance;
      ++rays;
      const Hit<D> hit = tracer_.intersect(point, direction);
      if (hit.kind == HitKind::none) return radiance;
      point = tracer_.surface_point(hit, direction, point.isovalue);
      const double choice = random.uniform();
      const std::array<double, 2> on_light{random.uniform(), random.uniform()};
      radiance += throughput * lights_.direct_radiance(point, choice, on_light, rays);
      sample = {random.uniform(), random.uniform()};
    }
  }

 private:
  const SceneTracer<D>& tracer_;
  const LightSampler<D>& lights_;
};

template <int D>
class VolumetricEstimator final : public IndirectEstimator<D> {
 public:
  VolumetricEstimator(const LeafCache<D>& leaves, const TexelLattice<D>& lattice)
      : leaves_(leaves), lattice_(lattice) {}

  Rgb indirect_radiance(const SurfacePoint<D>& point, const std::array<double, 2>&, Random&,
                        std::uint64_t&) const override {
    const std::int32_t slot = lattice_.nearest_slot(point.cell_point.index_position());
    if (slot == TexelLattice<D>::inactive) return Rgb(0);
    const Rgb irradiance = point.above ? leaves_.inner(slot) : leaves_.outer_indirect(slot);
    return irradiance * point.albedo / static_cast<Real>(projected_hemisphere<D>);
  }

 private:
  const LeafCache<D>& leaves_;
  const TexelLattice<D>& lattice_;
};

template <int D>
class GatherEstimator final : public IndirectEstimator<D> {
 public:
  GatherEstimator(const SceneTracer<D>& tracer, const LeafCache<D>& leaves,
                  const SurfaceCache<D>& surroundings, const TexelLattice<D>& lattice,
                  const std::vector<Rgb>& outer_direct)
      : tracer_(tracer), leaves_(leaves), surroundings_(surroundings), lattice_(lattice) {
    const Rgb brdf = tracer.scene().leaf_albedo / static_cast<Real>(projected_hemisphere<D>);
    outer_.resize(outer_direct.size());
    for (std::size_t s = 0; s < outer_.size(); ++s) {
      outer_[s] = outer_direct[s] + brdf * leaves.outer_indirect(static_cast<std::int32_t>(s));
    }
  }

  Rgb indirect_radiance(const SurfacePoint<D>& point, const std::array<double, 2>& u, Random&,
                        std::uint64_t& rays) const override {
    const Vec<D> direction = sample_cosine_hemisphere<D>(point.shading_normal, u);
    if (!leaves_surface(point, direction)) return Rgb(0);
    ++rays;
    const Hit<D> hit = tracer_.intersect(point, direction);
    return point.albedo * incident(hit, direction, point.isovalue);
  }

 private:
  Rgb incident(const Hit<D>& hit, const Vec<D>& direction, double isovalue) const {
    if (hit.kind == HitKind::none) return Rgb(0);
    if (hit.kind == HitKind::surroundings) {
      return surroundings_.radiance(hit.surroundings, direction, isovalue);
    }
    const std::int32_t slot = slot_before(hit.leaf);
    if (slot == TexelLattice<D>::inactive) return Rgb(0);
    if (!hit.leaf.from_above) return outer_[slot];
    return leaves_.inner(slot) * tracer_.scene().leaf_albedo /
           static_cast<Real>(projected_hemisphere<D>);
  }

  // The texel half a texel before the surface that was met: those within a thin shell hold the
  // light of both its faces, and would let the outer one's shine into it.
  std::int32_t slot_before(const LeafHit<D>& hit) const {
    const Vec<D> position = hit.point.index_position();
    const Vec<D> gradient =
        geometric_gradient(load_corners(tracer_.scene().field, hit.point.cell), hit.point.local);
    const double length = gradient.length();
    if (length > 0) {
      const Vec<D> before = gradient * ((hit.from_above ? 0.5 : -0.5) / length);
      const std::int32_t slot =
          lattice_.nearest_slot(position + before * lattice_.voxels_per_texel);
      if (slot != TexelLattice<D>::inactive) return slot;
    }
    return lattice_.nearest_slot(position);
  }

  const SceneTracer<D>& tracer_;
  const LeafCache<D>& leaves_;
  const SurfaceCache<D>& surroundings_;
  const TexelLattice<D>& lattice_;
  std::vector<Rgb> outer_;
};

}  // namespace

template <int D>
std::unique_ptr<IndirectEstimator<D>> make_path_estimator(const SceneTracer<D>& tracer,
                                                          const LightSampler<D>& lights) {
  return std::make_unique<PathEstimator<D>>(tracer, lights);
}

template <int D>
std::unique_ptr<IndirectEstimator<D>> make_volumetric_estimator(const LeafCache<D>& leaves,
                                                                const TexelLattice<D>& lattice) {
  return std::make_unique<VolumetricEstimator<D>>(leaves, lattice);
}

template <int D>
std::unique_ptr<IndirectEstimator<D>> make_gather_estimator(const SceneTracer<D>& tracer,
                                                            const LeafCache<D>& leaves,
                                                            const SurfaceCache<D>& surroundings,
                                                            const TexelLattice<D>& lattice,
                                                            const std::vector<Rgb>& outer_direct) {
  return std::make_unique<GatherEstimator<D>>(tracer, leaves, surroundings, lattice, outer_direct);
}

template class IndirectEstimator<2>;
template std::unique_ptr<IndirectEstimator<2>> make_path_estimator(const SceneTracer<2>&,
                                                                   const LightSampler<2>&);
template std::unique_ptr<IndirectEstimator<2>> make_volumetric_estimator(const LeafCache<2>&,
                                                                         const TexelLattice<2>&);
template std::unique_ptr<IndirectEstimator<2>> make_gather_estimator(const SceneTracer<2>&,
                                                                     const LeafCache<2>&,
                                                                     const SurfaceCache<2>&,
                                                                     const TexelLattice<2>&,
                                                                     const std::vector<Rgb>&);
template class IndirectEstimator<3>;
template std::unique_ptr<IndirectEstimator<3>> make_path_estimator(const SceneTracer<3>&,
                                                                   const LightSampler<3>&);
template std::unique_ptr<IndirectEstimator<3>> make_volumetric_estimator(const LeafCache<3>&,
                                                                         const TexelLattice<3>&);
template std::unique_ptr<IndirectEstimator<3>> make_gather_estimator(const SceneTracer<3>&,
                                                                     const LeafCache<3>&,
                                                                     const SurfaceCache<3>&,
                                                                     const TexelLattice<3>&,
                                                                     const std::vector<Rgb>&);

}  // namespace leaflight

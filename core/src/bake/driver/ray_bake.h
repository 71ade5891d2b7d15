// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "bake/driver/integrator.h"
#include "bake/driver/texel_light.h"
#include "bake/texels/point_sampler.h"
#include "bake/walls/wall_light.h"

namespace leaflight {

// Bake of any scene by paths, including several volumes, mirrors and glass. Each block traces paths
// from each texel. Photons carry caustics; each block traces its own, so that blocks are
// independent (progressive photon mapping, Hachisuka et al. 2008). Direct light of light points is
// exact on front sides; shadow rays sample the rest.
template <int D>
class RayBake final : public Integrator<D> {
 public:
  // `previous`: light of each volume at the same texels with equal settings, or null.
  RayBake(LitScene<D>& scene, std::vector<BakeTexels<D>> texels,
          const std::vector<PreviousLight<D>>* previous = nullptr);

  void add(int blocks, const std::function<bool()>& go_on = {}) override;
  void serialize(Archive& archive) override;
  int blocks() const override { return previous_blocks_ + blocks_; }
  double cost() const override;

  std::vector<RadianceGrid<D>> grids() override;
  const IsovalueErrors& errors() const override { return errors_; }
  WallRadiance<D> walls() override {
    return walls_->radiance(scene_.direct_of_walls, scene_.progress);
  }

 private:
  void add_block(int number, bool texels);
  void gather(std::size_t volume, bool back, const PointSampler<D>& from,
              const IndirectEstimator<D>& estimator, std::uint64_t seed, TexelMoments& moments);
  // Returns a sampler of the direct light that a side's maps lack.
  const LightSampler<D>& sampled(bool back) const;

  LitScene<D>& scene_;
  LightSampler<D> wide_;  // all lights except the light points
  std::vector<Index<D>> shown_;
  std::vector<TexelLattice<D>> lattices_;               // of indirect light; one per volume
  std::vector<std::unique_ptr<TexelLight<D>>> stored_;  // one per volume, or null
  std::uint64_t photons_;                               // per block
  std::optional<WallLight<D>> walls_;
  int blocks_ = 0, previous_blocks_;
  IsovalueErrors errors_;
};

}  // namespace leaflight

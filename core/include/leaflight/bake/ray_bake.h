// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "leaflight/bake/point_sampler.h"
#include "leaflight/bake/swept_bake.h"
#include "leaflight/bake/wall_light.h"

namespace leaflight {

// Light of any scene by rays: of several volumes, beside mirrors and glass. Each block traces
// photons of its own, and a few rays from each texel that look them up, so that blocks are
// independent in all that is random (progressive photon mapping, Hachisuka et al. 2008). Direct
// light of points is exact on outer sides; rays sample the rest of it.
template <int D>
class RayBake final : public Integrator<D> {
 public:
  // `kept`: of each volume, of the same texels and settings; null: nothing.
  RayBake(LitScene<D>& scene, std::vector<SweptTexels<D>> texels,
          const std::vector<KeptLight<D>>* kept = nullptr);

  void add(int blocks, const std::function<bool()>& go_on = {}) override;
  void keep(Keeper& keeper) override;
  int blocks() const override { return kept_blocks_ + blocks_; }
  double cost() const override;

  std::vector<RadianceGrid<D>> grids() override;
  const LeafErrors& errors() const override { return errors_; }
  SurroundingsRadiance<D> surroundings() override { return walls_->radiance(scene_.progress); }

 private:
  void add_block();
  PhotonCaches<D> trace_photons(std::uint64_t seed) const;
  std::vector<LeafRadiance<D>> looked_up(const PhotonCaches<D>& photons, std::uint64_t seed);
  std::vector<Rgb> direct_at_texels(std::size_t volume, bool inner, std::uint64_t seed);
  void gather(std::size_t volume, bool inner, const PointSampler<D>& from,
              const IndirectEstimator<D>& estimator, std::uint64_t seed, TexelMoments& moments);
  // What direct light of a side its maps lack.
  const LightSampler<D>& sampled(bool inner) const;

  LitScene<D>& scene_;
  LightSampler<D> wide_;  // without the lights' points
  std::vector<Index<D>> shown_;
  std::vector<TexelLattice<D>> lattices_;              // of indirect light, of each volume
  std::vector<std::unique_ptr<SweptBake<D>>> stored_;  // of each volume; null: none
  // Exact direct light at the texels, by volume and side, while rays look it up.
  std::vector<std::array<std::vector<Rgb>, 2>> direct_;
  std::uint64_t photons_;  // of a block
  std::optional<WallLight<D>> walls_;
  int blocks_ = 0, kept_blocks_;
  LeafErrors errors_;
};

}  // namespace leaflight

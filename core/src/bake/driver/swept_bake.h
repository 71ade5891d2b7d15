// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "bake/driver/integrator.h"
#include "bake/driver/lit_scene.h"
#include "bake/indirect/filtered_light.h"
#include "bake/indirect/indirect_light.h"
#include "bake/indirect/kept_light.h"
#include "bake/indirect/leaf_light.h"
#include "bake/indirect/photon_caches.h"

namespace leaflight {

// Where a bake by sweeps knows light.
template <int D>
struct SweptTexels {
  SweptLattice<D> shown;           // the texels of the result
  SweptLattice<D> soft;            // those of soft light
  int spacing = 1;                 // of the lines for soft light, in its texels
  TexelLattice<D> photons;         // what photons fall into
  std::uint64_t photon_count = 0;  // 0: their light comes by keep_looked_up()
};

// One volume's bake by sweeps, from nothing, or from what others have kept, to any number of blocks
// of indirect light, beside direct light, which is exact.
template <int D>
class SweptBake final : public Integrator<D> {
 public:
  // `volume`: its number. `kept`: of the same texels and settings; null: nothing. `workers`: who
  // sweeps blocks; null: nobody else.
  SweptBake(LitScene<D>& scene, std::size_t volume, SweptTexels<D> texels,
            const KeptLight<D>* kept = nullptr, const BlockWorkers* workers = nullptr);

  void add(int blocks, const std::function<bool()>& go_on = {}) override;
  void keep(Keeper& keeper) override;
  // What lines of indirect light look up, from a bake to the one of a sweeper (block_sweeper.h).
  void keep_looked_up(Keeper& keeper);
  // Another block, of which fill() makes the open sums, instead of lines.
  void add_block(const std::function<void(SideMoments&)>& fill);
  // Frees what only blocks need.
  void release();
  // A block for another bake that has asked for it, as block_bytes().
  std::string sweep_for_others(int number);
  int blocks() const override {
    return indirect_ ? indirect_->blocks() + (kept_ ? kept_->blocks() : 0) : 0;
  }
  // In points of lines.
  double cost() const override { return indirect_ ? indirect_->cost() : 0; }

  RadianceGrid<D> grid();
  std::vector<RadianceGrid<D>> grids() override;
  const LeafErrors& errors() const override { return errors_; }

  SurroundingsRadiance<D> surroundings() override;

 private:
  // Exact direct light at the texels of a lattice; none of a side whose maps are not known.
  std::vector<Rgb> direct_at(const TexelLattice<D>& lattice, bool inner) const;
  void trace_photons(const TexelLattice<D>& texels, std::uint64_t count);
  void keep_soft(Keeper& keeper);
  std::vector<Average> direct_averages(bool inner);
  std::vector<Rgb> soft_of_photons(bool inner) const;
  void learn_soft();
  void learn_inner_direct();
  void learn_leaf_light();
  GatheredRadiance<D> gathered() const;
  void finish(std::vector<Average>& indirect) const;
  std::array<NoisyLight, 2> filtered_light(UnfilteredLight<D>& unfiltered);
  void measure_texture(const NoisyLight& light);
  void measure_errors(const std::vector<Average>& direct, const std::vector<Average>& indirect);

  SweptVolume<D> volume_;
  const LightSampler<D>& lights_;
  const SplitLight<D>& split_;
  std::shared_ptr<const DirectLight<D>> direct_;
  std::optional<EnvironmentSampler<D>> sky_;  // that has no points
  const BakeSettings<D>& settings_;
  const Plan& plan_;
  Progress& progress_;
  std::atomic<std::uint64_t>& rays_;
  const KeptLight<D>* kept_;     // may be null
  const BlockWorkers* workers_;  // may be null
  SweptLattice<D> texels_;
  std::array<std::vector<Rgb>, 2> direct_texels_;  // direct light there, once it is asked for
  std::vector<TexelSurface<D>> surfaces_;          // at the texels of indirect light
  // What these miss of the light of white leaves between them: a mean square over its colours.
  std::vector<float> texture_;
  LeafLight<D> leaf_light_;                     // while lines look it up
  std::unique_ptr<IndirectLight<D>> indirect_;  // null: nothing reflects
  std::vector<TexelLattice<D>> lattices_;       // of the photons
  PhotonCaches<D> photons_;
  // Of white leaves' sides, at the texels of soft light, while lines look it up.
  std::array<std::vector<Rgb>, 2> soft_;
  std::vector<Rgb> inner_direct_;  // there, too
  int bounces_ = 0;                // gathered so far
  LeafErrors errors_;
};

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "bake/driver/integrator.h"
#include "bake/driver/lit_scene.h"
#include "bake/indirect/direct_lookup.h"
#include "bake/indirect/filtered_light.h"
#include "bake/indirect/indirect_light.h"
#include "bake/indirect/photon_caches.h"
#include "bake/indirect/previous_light.h"

namespace leaflight {

// The texels at which a bake by lines stores light.
template <int D>
struct BakeTexels {
  IndexedLattice<D> shown;         // the texels of the result
  IndexedLattice<D> indirect;      // those of indirect light
  int spacing = 1;                 // of the lines for indirect light, in its texels
  TexelLattice<D> photons;         // what photons fall into
  std::uint64_t photon_count = 0;  // 0: their light comes by serialize_lookups()
  int wall_samples = 0;            // shadow rays of each patch of the walls
};

// One volume's bake by lines, from nothing, or from a previous bake, to any number of
// blocks of indirect light, beside direct light, which is exact.
template <int D>
class LineBake final : public Integrator<D> {
 public:
  // `volume`: its number. `previous`: of the same texels and settings; null: nothing. `workers`:
  // who traces blocks; null: nobody else.
  LineBake(LitScene<D>& scene, std::size_t volume, BakeTexels<D> texels,
           const PreviousLight<D>* previous = nullptr, const BlockWorkers* workers = nullptr);

  void add(int blocks, const std::function<bool()>& go_on = {}) override;
  void serialize(Archive& archive) override;
  // What lines of indirect light look up, from a bake to that of a BlockTracer.
  void serialize_lookups(Archive& archive);
  // Another block, of which fill() makes the open sums, instead of lines.
  void add_block(const std::function<void(SideMoments&)>& fill);
  // Frees what only blocks need.
  void release();
  // A block for another bake that has asked for it, as block_bytes().
  std::string traced_block(int number);
  int blocks() const override {
    return indirect_ ? indirect_->blocks() + (previous_ ? previous_->blocks() : 0) : 0;
  }
  // In points of lines.
  double cost() const override { return indirect_ ? indirect_->cost() : 0; }

  RadianceGrid<D> grid();
  std::vector<RadianceGrid<D>> grids() override;
  const IsovalueErrors& errors() const override { return errors_; }

  WallRadiance<D> walls() override;

 private:
  // Exact direct light at the texels of a lattice; none of a side whose maps are not known.
  std::vector<Rgb> direct_at(const TexelLattice<D>& lattice, bool back) const;
  void trace_photons(const BakeTexels<D>& texels);
  void serialize_indirect(Archive& archive);
  std::vector<Average> direct_averages(bool back);
  std::vector<Rgb> indirect_of_photons(bool back) const;
  void learn_indirect();
  void gather_bounces();
  void learn_back_direct();
  void learn_lookups();
  void learn_surfaces();
  GatheredRadiance<D> gathered() const;
  void finish(std::vector<Average>& indirect) const;
  std::array<NoisyLight, 2> filtered_light(UnfilteredLight<D>& unfiltered);
  void measure_noise(const std::vector<Average>& direct, const std::vector<Average>& indirect);

  LitScene<D>& scene_;
  LineVolume<D> volume_;
  const LightSampler<D>& lights_;
  const SplitLight<D>& split_;
  // Of the scene: coarser maps while the first picture is made.
  const std::shared_ptr<const DirectLight<D>>& direct_;
  std::optional<EnvironmentSampler<D>> sky_;  // that has no points
  const BakeSettings<D>& settings_;
  const Plan& plan_;
  Progress& progress_;
  const PreviousLight<D>* previous_;  // may be null
  const BlockWorkers* workers_;       // may be null
  IndexedLattice<D> texels_;
  std::array<std::vector<Rgb>, 2> direct_texels_;  // direct light there, once it is asked for
  std::vector<TexelSurface<D>> surfaces_;          // at the texels of indirect light
  DirectLookup<D> direct_lookup_;                  // while lines look it up
  std::unique_ptr<IndirectLight<D>> indirect_;     // null: nothing reflects
  std::vector<TexelLattice<D>> lattices_;          // of the photons
  PhotonCaches<D> photons_;
  // Of white isosurfaces' sides, at the texels of indirect light, while lines look it up.
  std::array<std::vector<Rgb>, 2> indirect_sides_;
  std::vector<Rgb> back_direct_;  // there, too
  IsovalueErrors errors_;
};

}  // namespace leaflight

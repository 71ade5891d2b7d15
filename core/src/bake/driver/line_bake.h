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
  IndexedLattice<D> shown;         // texels of the result
  IndexedLattice<D> indirect;      // texels of indirect light
  int spacing = 1;                 // of the lines, in texels of indirect light
  TexelLattice<D> photons;         // texels that collect photons
  std::uint64_t photon_count = 0;  // 0: serialize_lookups() reads their light
  int wall_samples = 0;            // shadow rays per patch of the walls
};

// One volume's bake by lines. It has any number of blocks of indirect light, and exact direct
// light. It starts empty or continues a previous bake.
template <int D>
class LineBake final : public Integrator<D> {
 public:
  // `volume`: its number. `previous`: light at the same texels with equal settings, or null.
  // `workers`: processes that trace blocks, or null.
  LineBake(LitScene<D>& scene, std::size_t volume, BakeTexels<D> texels,
           const PreviousLight<D>* previous = nullptr, const BlockWorkers* workers = nullptr);

  void add(int blocks, const std::function<bool()>& go_on = {}) override;
  void serialize(Archive& archive) override;
  // Transfers the inputs of the lines from a bake to a BlockTracer.
  void serialize_lookups(Archive& archive);
  // Adds a block whose open sums come from `fill` instead of lines.
  void add_block(const std::function<void(SideMoments&)>& fill);
  // Frees the data that only blocks need.
  void release();
  // Traces a block for another bake and returns it as block_bytes() does.
  std::string traced_block(int number);
  int blocks() const override {
    return indirect_ ? indirect_->blocks() + (previous_ ? previous_->blocks() : 0) : 0;
  }
  // Returns the work of a block, in the unit of the progress: points of lines.
  double cost() const override { return indirect_ ? indirect_->cost() : 0; }

  RadianceGrid<D> grid();
  std::vector<RadianceGrid<D>> grids() override;
  const IsovalueErrors& errors() const override { return errors_; }

  WallRadiance<D> walls() override;

 private:
  // Computes exact direct light at the texels of a lattice; returns nothing for a side without
  // maps.
  std::vector<Rgb> direct_at(const TexelLattice<D>& lattice, bool back) const;
  void compute_texture();
  void trace_photons(const BakeTexels<D>& texels);
  void serialize_indirect(Archive& archive);
  std::vector<Rgb> indirect_of_photons(bool back) const;
  void compute_indirect_sides();
  void gather_bounces();
  void compute_back_direct();
  void compute_direct_lookup();
  void compute_surfaces();
  GatheredRadiance<D> gathered() const;
  void finish(std::vector<Average>& indirect) const;
  std::vector<Rgb> looked_up(const std::vector<Average>& averages);
  std::array<NoisyLight, 2> filtered_light(UnfilteredLight<D>& unfiltered);
  void measure_noise(const std::vector<Average>& indirect);

  LitScene<D>& scene_;
  LineVolume<D> volume_;
  const LightSampler<D>& lights_;
  const SplitLight<D>& split_;
  // Maps of the scene, which are coarser for the first picture.
  const std::shared_ptr<const DirectLight<D>>& direct_;
  std::optional<EnvironmentSampler<D>> sky_;  // without the light points
  const BakeSettings<D>& settings_;
  const Plan& plan_;
  Progress& progress_;
  const PreviousLight<D>* previous_;  // may be null
  const BlockWorkers* workers_;       // may be null
  IndexedLattice<D> texels_;
  std::array<std::vector<Rgb>, 2> direct_texels_;  // direct light at texels_, after its first use
  std::vector<TexelSurface<D>> surfaces_;          // isosurfaces at the texels of indirect light
  DirectLookup<D> direct_lookup_;                  // empty if no lines need it
  std::unique_ptr<IndirectLight<D>> indirect_;     // null: nothing reflects
  std::vector<TexelLattice<D>> lattices_;          // texels that collect photons
  PhotonCaches<D> photons_;
  // Light of both sides of white isosurfaces at the texels of indirect light; empty when no lines
  // need it.
  std::array<std::vector<Rgb>, 2> indirect_sides_;
  std::vector<Rgb> back_direct_;  // at the same texels
  std::vector<Rgb> texture_;      // texture of the volume at the same texels; empty: none
  IsovalueErrors errors_;
};

}  // namespace leaflight

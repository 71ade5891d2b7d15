// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "bake/driver/integrator.h"
#include "bake/driver/texel_light.h"
#include "bake/indirect/direct_lookup.h"
#include "bake/indirect/photon_caches.h"

namespace leaflight {

// Bake of one volume by lines, each of which lights all texels on it. Its lines look up direct
// light, indirect light of earlier blocks, and the walls.
template <int D>
class LineBake final : public Integrator<D> {
 public:
  // `previous`: light at the same texels with equal settings, or null. `workers`: processes that
  // trace blocks, or null.
  LineBake(LitScene<D>& scene, BakeTexels<D> texels, const PreviousLight<D>* previous = nullptr,
           const BlockWorkers* workers = nullptr);

  void add(int blocks, const std::function<bool()>& go_on = {}) override;
  void serialize(Archive& archive) override;
  // Transfers the inputs of the lines from a bake to a BlockTracer.
  void serialize_lookups(Archive& archive);
  // Traces a block for another bake and returns it as block_bytes() does.
  std::string traced_block(int number);
  int blocks() const override { return light_.blocks(); }
  // Returns the work of a block, in the unit of the progress: points of lines.
  double cost() const override { return indirect_ ? indirect_->cost() : 0; }

  std::vector<RadianceGrid<D>> grids() override;
  const IsovalueErrors& errors() const override { return light_.errors(); }

  WallRadiance<D> walls() override;

 private:
  const Volume<D>& volume() const { return light_.volume().volume(); }
  void compute_texture();
  void trace_photons(const BakeTexels<D>& texels);
  void serialize_indirect(Archive& archive);
  std::vector<Rgb> indirect_of_photons(bool back) const;
  void compute_indirect_sides();
  void gather_bounces();
  void compute_back_direct();
  void compute_direct_lookup();
  GatheredRadiance<D> gathered();
  std::vector<Rgb> looked_up(const std::vector<Average>& averages);
  // Frees the data that only blocks need.
  void release();

  LitScene<D>& scene_;
  TexelLight<D> light_;
  IndirectLight<D>* indirect_;                // that of light_; null: nothing reflects
  std::optional<EnvironmentSampler<D>> sky_;  // without the light points
  const BlockWorkers* workers_;               // may be null
  DirectLookup<D> direct_lookup_;             // empty if no lines need it
  std::vector<TexelLattice<D>> lattices_;     // texels that collect photons
  PhotonCaches<D> photons_;
  // Light of both sides of white isosurfaces at the texels of indirect light; empty when no lines
  // need it.
  std::array<std::vector<Rgb>, 2> indirect_sides_;
  std::vector<Rgb> back_direct_;  // at the same texels
  std::vector<Rgb> texture_;      // texture of the volume at the same texels; empty: none
};

}  // namespace leaflight

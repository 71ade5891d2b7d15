// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "bake/driver/integrator.h"
#include "bake/driver/texel_light.h"
#include "bake/indirect/direct_lookup.h"
#include "bake/indirect/photon_light.h"
#include "bake/walls/wall_parts.h"

namespace leaflight {

// Bake of one volume by lines, each of which lights all texels on it. Its lines look up direct
// light, indirect light of earlier blocks, and the walls.
template <int D>
class LineBake final : public Integrator<D> {
 public:
  // `previous`: light at the same texels with equal settings, or null. `workers`: processes that
  // compute parts, or null.
  LineBake(LitScene<D>& scene, BakeTexels<D> texels, const PreviousLight<D>* previous = nullptr,
           const Workers* workers = nullptr);

  void add(int blocks, const std::function<bool()>& go_on = {}) override;
  void serialize(Archive& archive) override;
  // Reads data of a bake in a worker.
  void read(PartData kind, std::istream& stream);
  // Computes a part for another process: photons, bounces, a block or walls.
  std::string traced(const BakePart& part);
  int blocks() const override { return light_.blocks(); }
  // Returns the work of a block, in the unit of the progress: points of lines.
  double cost() const override { return indirect_ ? indirect_->cost() : 0; }

  std::vector<RadianceGrid<D>> grids() override;
  const IsovalueErrors& errors() const override { return light_.errors(); }

  WallRadiance<D> walls() override;

 private:
  const Volume<D>& volume() const { return light_.volume().volume(); }
  void compute_texture();
  // True if lines gather light for a side.
  bool gathers(bool back) const { return !back || scene_.plan.back; }
  // Traces photons, or lets a worker do it.
  void find_photons(std::uint64_t count);
  void trace_photons(int number, std::uint64_t count);
  void compute_indirect_sides();
  // Computes the first bounces, or lets a worker do it.
  void gather_bounces();
  void gather_bounces_here();
  void send(PartData kind, const std::function<void(Archive)>& write) const;
  void serialize_lines(Archive& archive, bool is_dark);
  void make_wall_parts();
  void compute_radiance();
  std::vector<std::string> walls_of_workers(const std::vector<BakePart>& parts);
  void compute_back_direct();
  void compute_direct_lookup();
  GatheredRadiance<D> gathered();
  std::vector<Rgb> looked_up(const std::vector<Average>& averages);
  // Frees the data that only blocks need.
  void release();

  LitScene<D>& scene_;
  TexelLight<D> light_;
  IndirectLight<D>* indirect_;                    // that of light_; null: nothing reflects
  std::optional<EnvironmentSampler<D>> sky_;      // without the light points
  const Workers* workers_;                        // may be null
  bool has_lines_ = false;                        // true if a worker has their lookups
  std::optional<DirectLookup<D>> direct_lookup_;  // null if no lines need it
  PhotonLight<D> photons_;
  // Light of both sides of white isosurfaces at the texels of indirect light; empty when no lines
  // need it.
  std::array<std::vector<Rgb>, 2> indirect_sides_;
  std::vector<Rgb> back_direct_;  // at the same texels
  std::vector<Rgb> texture_;      // texture of the volume at the same texels; empty: none
  // The light of the isosurfaces for paths from walls, and those paths; empty before they start.
  std::vector<IsosurfaceRadiance<D>> isosurfaces_;
  std::unique_ptr<IndirectEstimator<D>> gather_;
  std::unique_ptr<WallParts<D>> wall_parts_;
};

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "leaflight/bake/direct_light.h"
#include "leaflight/bake/indirect_light.h"
#include "leaflight/bake/photon_caches.h"
#include "leaflight/bake/radiance_grid.h"
#include "leaflight/bake/surroundings_radiance.h"

namespace leaflight {

// Where a bake by sweeps knows light.
template <int D>
struct SweptTexels {
  SweptLattice<D> direct;   // the texels of the result
  SweptLattice<D> soft;     // those of soft light
  int spacing = 1;          // of the lines for soft light, in its texels
  TexelLattice<D> photons;  // what photons fall into
  std::uint64_t photon_count = 0;
};

// One volume's bake by sweeps, from nothing to any number of blocks: the passes and what they know
// of each other's light. What is asked for at any time is a whole bake.
template <int D>
class SweptBake {
 public:
  SweptBake(const SweptVolume<D>& volume, const LightSampler<D>& lights,
            const BakeSettings<D>& settings, const Plan& plan, Progress& progress,
            std::atomic<std::uint64_t>& rays, SweptTexels<D> texels);

  // Sweeps more blocks of either light.
  void add(int direct_blocks, int indirect_blocks);
  int direct_blocks() const { return direct_.blocks(); }
  int indirect_blocks() const { return indirect_ ? indirect_->blocks() : 0; }
  // Of a block, in points of lines.
  double direct_cost() const { return direct_.cost(); }
  double indirect_cost() const { return indirect_ ? indirect_->cost() : 0; }

  RadianceGrid<D> grid();
  // Mean squares, over points of the leaves, of the standard errors of the colours that grid()
  // found.
  double direct_noise() const { return direct_noise_; }
  double indirect_noise() const { return indirect_noise_; }
  // The mean square of what the texels miss of the colours between them, estimated likewise.
  double texture_error() const { return texture_error_; }

  SurroundingsRadiance<D> surroundings();

 private:
  void trace_photons(const TexelLattice<D>& texels, std::uint64_t count);
  void learn_soft();
  void learn_inner_direct();
  GatheredRadiance<D> gathered() const;
  void finish(std::vector<Average>& direct, std::vector<Average>& indirect);
  double texture_error(const std::vector<Average>& direct, const std::vector<Average>& indirect,
                       std::size_t slot) const;
  void measure_noise(const std::vector<Average>& direct, const std::vector<Average>& indirect);

  SweptVolume<D> volume_;
  const LightSampler<D>& lights_;
  const BakeSettings<D>& settings_;
  const Plan& plan_;
  Progress& progress_;
  std::atomic<std::uint64_t>& rays_;
  SweptLattice<D> texels_;
  DirectLight<D> direct_;
  std::unique_ptr<IndirectLight<D>> indirect_;  // null: nothing reflects
  std::vector<TexelLattice<D>> lattices_;       // of the photons
  PhotonCaches<D> photons_;
  std::array<std::vector<Rgb>, 2> soft_;  // of white leaves' sides, at the texels of soft light
  std::vector<Rgb> inner_direct_;         // there too
  double direct_noise_ = 0, indirect_noise_ = 0, texture_error_ = 0;
};

}  // namespace leaflight

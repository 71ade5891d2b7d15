// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "bake/driver/lit_scene.h"
#include "bake/indirect/filtered_light.h"
#include "bake/indirect/indirect_light.h"
#include "bake/indirect/previous_light.h"
#include "bake/output/radiance_grid.h"
#include "bake/texels/isovalue_error.h"

namespace leaflight {

// The texels of one volume at which a bake stores light.
template <int D>
struct BakeTexels {
  IndexedLattice<D> shown;     // texels of the result
  IndexedLattice<D> indirect;  // texels of indirect light
  int spacing = 1;             // of the lines, in texels of indirect light
  TexelLattice<D> photons;     // texels that collect photons
  std::uint64_t photon_count = 0;
  int wall_samples = 0;  // shadow rays per patch of the walls
};

// The light of one volume at its texels: exact direct light, and the average of any number of
// blocks of indirect light. It starts empty or continues a previous bake.
template <int D>
class TexelLight {
 public:
  // `volume`: its number. `previous`: light at the same texels with equal settings, or null.
  // `first_block`: of indirect light, for its seeds.
  TexelLight(LitScene<D>& scene, std::size_t volume, BakeTexels<D>& texels,
             const PreviousLight<D>* previous, int first_block);

  const LineVolume<D>& volume() const { return volume_; }
  // Returns the direct light of the scene, which is coarser for the first picture.
  const DirectLight<D>& direct() const { return *direct_; }
  // Returns the new blocks of indirect light; null if nothing reflects.
  IndirectLight<D>* indirect() const { return indirect_.get(); }
  // Returns the lattice of the indirect light.
  const TexelLattice<D>& lattice() const { return indirect_->texels().lattice; }
  // Returns the number of all blocks, including those of the previous bake.
  int blocks() const {
    return indirect_ ? indirect_->blocks() + (previous_ ? previous_->blocks() : 0) : 0;
  }
  // True if it has indirect light, new or of the previous bake.
  bool has_blocks() const { return previous_ || indirect_->blocks() > 0; }
  // Returns the averages of a side with the previous bake, as if isosurfaces were white.
  std::vector<Average> averages(bool back) const;
  // Returns the isosurfaces at the texels of indirect light, which the first call computes.
  const std::vector<TexelSurface<D>>& surfaces();
  // Computes exact direct light at the texels of a lattice; returns black for a side without maps.
  std::vector<Rgb> direct_at(const TexelLattice<D>& lattice, bool back) const;

  RadianceGrid<D> grid();
  // Returns the noise of the last grid().
  const IsovalueErrors& errors() const { return errors_; }
  // Serializes the new blocks.
  void serialize(Archive& archive);

 private:
  std::array<NoisyLight, 2> filtered_light(UnfilteredLight<D>& unfiltered);
  Average finished(const std::vector<Average>& white, std::size_t slot) const;
  void measure_noise(const std::vector<Average>& white);

  LitScene<D>& scene_;
  LineVolume<D> volume_;
  const std::shared_ptr<const DirectLight<D>>& direct_;
  const PreviousLight<D>* previous_;  // may be null
  IndexedLattice<D> texels_;          // of the result
  std::unique_ptr<IndirectLight<D>> indirect_;
  std::vector<TexelSurface<D>> surfaces_;
  IsovalueErrors errors_;
};

}  // namespace leaflight

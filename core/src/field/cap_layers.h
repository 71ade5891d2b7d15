// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "field/texel_lattice.h"

namespace leaflight {

// All isosurfaces lie on the cap of a cut, within a voxel, where they share the texels. Their light
// differs: high ones leave holes, which low ones close. So texels on a cap have layers, which are
// equal ranges of isovalues. A texel itself holds the light of isosurfaces beside the cap.

// Adds layers to the texels that the cap of a cut can reach, for isovalues between two values.
template <int D>
void add_cap_layers(const Field<D>& field, double low, double high, TexelLattice<D>& lattice);

// Returns the slots for the isosurface through an index position: two layers on a cap, with linear
// weights between their middle values, else the texels around it.
template <int D>
TexelWeights<D> surface_weights(const Field<D>& field, const TexelLattice<D>& lattice,
                                const Vec<D>& index_position);

// Turns the weights of texels into those of their layers for a value of the field. Leaves them as
// they are if none has layers.
template <int D>
TexelWeights<D> layer_weights(const TexelLattice<D>& lattice, const TexelWeights<D>& texels,
                              double value);

// Returns the place of a slot in index coordinates: the center of its texel, for a layer moved to
// the plane of its isovalue.
template <int D>
Vec<D> slot_position(const Field<D>& field, const TexelLattice<D>& lattice, std::size_t slot);

// Returns the value of the field at a slot; NaN in masked cells.
template <int D>
double slot_value(const Field<D>& field, const TexelLattice<D>& lattice, std::size_t slot);

// Returns the shading gradient at a place near a slot: on a cap that of the ramp for its layers,
// and that of the uncut values for the texel itself.
template <int D>
Vec<D> slot_gradient(const Field<D>& field, const TexelLattice<D>& lattice, std::size_t slot,
                     const Vec<D>& index_position);

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#include "field/cap_layers.h"

#include <gtest/gtest.h>

#include <numeric>

#include "field/shading_gradient.h"
#include "fields.h"

namespace leaflight {
namespace {

// A cut at x = 3.3 voxels through data of 1, which leaves what is on the right. Beyond the cut the
// ramp goes on to -2.
Field<3> cut_block() {
  constexpr int n = 8;
  std::vector<float> ramp, values;
  for (int i = 0; i < n * n * n; ++i) {
    ramp.push_back(std::max(-2.0f, static_cast<float>(i % n) - 3.3f));
    values.push_back(std::min(1.0f, ramp.back()));
  }
  Field<3> field = test::field_from<3>(values, {n, n, n}, test::unit_cube<3>(n));
  const auto owner = std::make_shared<std::vector<float>>(std::move(ramp));
  field.ramp = owner->data();
  field.ramp_owner = owner;
  field.ramp_step = 1;
  return field;
}

TexelLattice<3> layered(const Field<3>& field) {
  TexelLattice<3> lattice = make_lattice(field, field.dims, 0, 1);
  add_cap_layers(field, 0, 1, lattice);
  return lattice;
}

TEST(CapLayers, BelongToTexelsOfTheCap) {
  const Field<3> field = cut_block();
  const TexelLattice<3> lattice = layered(field);
  ASSERT_TRUE(lattice.has_layers());
  for (std::size_t s = 0; s < lattice.active.size(); ++s) {
    const int layer = lattice.layer(s), x = lattice.texel(lattice.active[s])[0];
    const auto slot = static_cast<std::int32_t>(s);
    EXPECT_EQ(
        layer < 0 ? lattice.slot[lattice.active[s]] : lattice.layer_slot(lattice.active[s], layer),
        slot);
    EXPECT_EQ(lattice.beside(s, lattice.active[s]), slot);
    if (layer >= 0) {
      EXPECT_LE(std::abs(x - 3.8), 2);
      EXPECT_EQ(lattice.layer_of(lattice.layer_value(layer)), layer);
    }
  }
}

TEST(CapLayers, AreReadAtTheIsovalueOfTheCap) {
  const Field<3> field = cut_block();
  const TexelLattice<3> lattice = layered(field);
  for (const double c : {0.1, 0.33, 0.6, 0.9}) {
    // In a dent, the interpolant is lower than the ramp.
    const TexelWeights<3> near = surface_weights(field, lattice, Vec3(3.3 + c, 4.2, 3.7));
    double sum = 0, value = 0;
    for (int i = 0; i < near.count; ++i) {
      const int layer = lattice.layer(near.slot[i]);
      ASSERT_GE(layer, 0);
      sum += near.weight[i];
      value += near.weight[i] * lattice.layer_value(layer);
    }
    EXPECT_NEAR(sum, 1, 1e-5);
    EXPECT_NEAR(value, std::clamp(c, 1.0 / 16, 15.0 / 16), 1e-5);
  }
}

TEST(CapLayers, LieOnTheirPlanes) {
  const Field<3> field = cut_block();
  const TexelLattice<3> lattice = layered(field);
  for (std::size_t s = lattice.active_texels; s < lattice.active.size(); ++s) {
    const Vec3 place = slot_position(field, lattice, s);
    const double plane = 3.3 + lattice.layer_value(lattice.layer(s));
    const double way = std::abs(plane - lattice.texel(lattice.active[s])[0]);
    if (way < 1) {
      EXPECT_NEAR(place.x, plane, 1e-4);
    }
    EXPECT_NEAR(slot_gradient(field, lattice, s, place).x, 1, 1e-4);
  }
}

TEST(CapLayers, AreAbsentWithoutACut) {
  const Field<3> field = test::ball<3>(9);
  TexelLattice<3> lattice = make_lattice(field, field.dims, 0.6, 0.9);
  add_cap_layers(field, 0.6, 0.9, lattice);
  EXPECT_FALSE(lattice.has_layers());
}

}  // namespace
}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/output/estimated_grid.h"

#include <Imath/ImathMatrix.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace leaflight {

namespace {

using Colors = std::vector<Vec<3, float>>;

// Distance from changed values at which the light of the bake counts, in voxels.
constexpr double reach_of_changes = 1.5;
// Difference of values that rounding of positions causes, relative to the isovalue range.
constexpr double rounding = 1e-4;
// Number of texels that a fit reads at most.
constexpr std::size_t most_fitted = 50'000;
// Least share of the mean light that a fit gives.
constexpr double least_share = 0.25;

// Spreads the marks (1) of texels to those within `reach` texels along each axis.
void spread_marks(std::vector<std::uint8_t>& marks, const Index<3>& resolution,
                  const Index<3>& reach) {
  std::size_t stride = 1;
  for (int a = 0; a < 3; ++a) {
    const auto count = static_cast<std::size_t>(resolution[a]);
    tbb::parallel_for(std::size_t{0}, marks.size() / count, [&](std::size_t line) {
      std::uint8_t* first = &marks[line / stride * stride * count + line % stride];
      // A spread mark is 2 until the end of the line, and spreads no further.
      const auto pass = [&](std::size_t i, int& left) {
        std::uint8_t& mark = first[i * stride];
        if (mark == 1) {
          left = reach[a];
        } else if (left > 0) {
          mark = 2;
          --left;
        }
      };
      int left = 0;
      for (std::size_t i = 0; i < count; ++i) pass(i, left);
      left = 0;
      for (std::size_t i = count; i-- > 0;) pass(i, left);
      for (std::size_t i = 0; i < count; ++i) {
        if (first[i * stride] == 2) first[i * stride] = 1;
      }
    });
    stride *= count;
  }
}

// Returns, for each texel of a lattice of `now`, 1 if values near it are not those of `before`.
std::vector<std::uint8_t> near_changes(const TexelLattice<3>& lattice, const Affine<3>& to_before,
                                       const Field<3>& before, const Field<3>& now,
                                       double tolerance) {
  std::vector<std::uint8_t> marks(lattice.texels());
  tbb::parallel_for(std::size_t{0}, marks.size(), [&](std::size_t texel) {
    const Vec3 center = lattice.center(static_cast<std::uint32_t>(texel));
    const Vec3 position = to_before.point(center);
    const double a = value_at(before, position), b = value_at(now, center);
    const bool same = std::isnan(a) == std::isnan(b) && !(std::abs(a - b) > tolerance);
    marks[texel] = !same || !inside(before, position);
  });
  Index<3> reach;
  for (int a = 0; a < 3; ++a) {
    reach[a] = static_cast<int>(std::ceil(reach_of_changes / lattice.voxels_per_texel[a]));
  }
  spread_marks(marks, lattice.resolution, reach);
  return marks;
}

// Light as a linear function of the unit normal, fitted by least squares.
class FittedLight {
 public:
  void add(const Vec3& normal, const Vec<3, float>& light) {
    const std::array<double, 4> row{1, normal.x, normal.y, normal.z};
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < 4; ++j) squares_[i][j] += row[i] * row[j];
      sums_[i] += Vec3(light) * row[i];
    }
  }
  bool is_empty() const { return squares_[0][0] == 0; }
  void solve() {
    // Keep the matrix regular if all normals are parallel.
    for (int i = 0; i < 4; ++i) squares_[i][i] *= 1 + 1e-6;
    for (int i = 1; i < 4; ++i) squares_[i][i] += 1e-6 * squares_[0][0];
    mean_ = sums_[0] / squares_[0][0];
    const Imath::M44d inverse = squares_.inverse();
    for (int i = 0; i < 4; ++i) {
      weights_[i] = Vec3(0.0);
      for (int j = 0; j < 4; ++j) weights_[i] += sums_[j] * inverse[i][j];
    }
  }
  Vec<3, float> at(const Vec3& normal) const {
    const Vec3 light =
        weights_[0] + weights_[1] * normal.x + weights_[2] * normal.y + weights_[3] * normal.z;
    Vec<3, float> found;
    for (int i = 0; i < 3; ++i) {
      found[i] = static_cast<float>(std::max(light[i], least_share * mean_[i]));
    }
    return found;
  }

 private:
  Imath::M44d squares_{0.0};
  std::array<Vec3, 4> sums_{Vec3(0.0), Vec3(0.0), Vec3(0.0), Vec3(0.0)}, weights_ = sums_;
  Vec3 mean_{0.0};
};

// Fits the light of a bake, or of one part of it, over the texels that lights reach. Takes all
// texels if lights reach none.
FittedLight fitted(const TexelLattice<3>& lattice, const Field<3>& field, const Colors& light,
                   const Colors& all, const Colors& indirect) {
  const std::size_t step = 1 + lattice.active.size() / most_fitted;
  FittedLight of_lit, of_all;
  for (std::size_t s = 0; s < lattice.active.size(); s += step) {
    const Vec3 normal = shading_normal(field, lattice.center(lattice.active[s]));
    if (normal == Vec3(0.0)) continue;
    of_all.add(normal, light[s]);
    if (largest(Rgb(all[s] - indirect[s])) > 0.1 * largest(Rgb(all[s]))) {
      of_lit.add(normal, light[s]);
    }
  }
  FittedLight found = of_lit.is_empty() ? of_all : of_lit;
  if (!found.is_empty()) found.solve();
  return found;
}

}  // namespace

RadianceGrid<3> estimated_grid(const RadianceGrid<3>& baked, const Field<3>& before,
                               const Field<3>& now, const Index<3>& resolution,
                               const IsovalueRange& isovalue_range) {
  RadianceGrid<3> grid;
  grid.lattice = make_lattice(now, resolution, isovalue_range.min, isovalue_range.max);
  const TexelLattice<3>& lattice = grid.lattice;
  Affine<3> to_before;
  for (int a = 0; a < 3; ++a) {
    to_before.column[a] = before.world_to_index.vector(now.index_to_world.column[a]);
  }
  to_before.origin = before.world_to_index.point(now.index_to_world.origin);
  const std::vector<std::uint8_t> changed =
      near_changes(lattice, to_before, before, now, rounding * isovalue_range.height());

  const auto estimate = [&](const Colors& light, const Colors& all, const Colors& indirect) {
    const FittedLight fit = fitted(baked.lattice, before, light, all, indirect);
    Colors found(lattice.active.size());
    tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t s) {
      const std::uint32_t texel = lattice.active[s];
      const Vec3 center = lattice.center(texel);
      found[s] = changed[texel] ? fit.at(shading_normal(now, center))
                                : lookup(baked.lattice, light, to_before.point(center));
    });
    return found;
  };
  grid.radiance = estimate(baked.radiance, baked.radiance, baked.radiance_indirect);
  grid.radiance_indirect =
      estimate(baked.radiance_indirect, baked.radiance, baked.radiance_indirect);
  if (baked.has_back()) {
    const Colors &all = baked.radiance_back, &indirect = baked.radiance_back_indirect;
    grid.radiance_back = estimate(all, all, indirect);
    grid.radiance_back_indirect = estimate(indirect, all, indirect);
  }
  grid.radiance_error.assign(lattice.active.size(), std::numeric_limits<float>::quiet_NaN());
  return grid;
}

}  // namespace leaflight

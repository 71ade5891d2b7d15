// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/output/estimated_grid.h"

#include <Imath/ImathMatrix.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "field/cap_layers.h"
#include "field/shading_gradient.h"

namespace leaflight {

namespace {

using Colors = std::vector<Vec<3, float>>;

// Distance from changed voxels up to which light is estimated, in voxels.
constexpr int reach_of_changes = 2;
// Largest distance of two voxels at the same place, in voxels.
constexpr double rounding = 1e-3;
// Number of texels that a fit reads at most.
constexpr std::size_t most_fitted = 50'000;
// Least share of the mean light that a fit gives.
constexpr double least_share = 0.25;

// Spreads the marks (1) of voxels to those within reach_of_changes along each axis.
void spread_marks(std::vector<std::uint8_t>& marks, const Index<3>& dims) {
  std::size_t stride = 1;
  for (int a = 0; a < 3; ++a) {
    const auto count = static_cast<std::size_t>(dims[a]);
    tbb::parallel_for(std::size_t{0}, marks.size() / count, [&](std::size_t line) {
      std::uint8_t* first = &marks[line / stride * stride * count + line % stride];
      // A spread mark is 2 until the end of the line, and spreads no further.
      const auto pass = [&](std::size_t i, int& left) {
        std::uint8_t& mark = first[i * stride];
        if (mark == 1) {
          left = reach_of_changes;
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

// Returns the voxel of another field that is where a field's first voxel is, if all voxels of the
// fields are at common places.
std::optional<Index<3>> first_voxel(const Affine<3>& to_other, const Index<3>& dims) {
  Index<3> voxel;
  for (int a = 0; a < 3; ++a) {
    voxel[a] = static_cast<int>(std::lround(to_other.origin[a]));
    if (std::abs(to_other.origin[a] - voxel[a]) > rounding) return std::nullopt;
    for (int b = 0; b < 3; ++b) {
      const double turn = to_other.column[a][b] - (a == b ? 1 : 0);
      if (std::abs(turn) * dims[a] > rounding) return std::nullopt;
    }
  }
  return voxel;
}

// Returns, for each voxel of `now`, 1 if values near it are not those of `before`.
std::vector<std::uint8_t> near_changes(const Affine<3>& to_before, const Field<3>& before,
                                       const Field<3>& now) {
  std::vector<std::uint8_t> marks(now.voxels(), 1);
  const std::optional<Index<3>> first = first_voxel(to_before, now.dims);
  if (!first) return marks;
  const auto rows = static_cast<std::size_t>(now.dims[1]) * now.dims[2];
  tbb::parallel_for(std::size_t{0}, rows, [&](std::size_t row) {
    const std::size_t number = row * now.dims[0];
    Index<3> voxel = index_of<3>(number, now.dims);
    for (int a = 0; a < 3; ++a) voxel[a] += (*first)[a];
    for (int a = 1; a < 3; ++a) {
      if (voxel[a] < 0 || voxel[a] >= before.dims[a]) return;
    }
    const int begin = std::max(0, -voxel[0]),
              end = std::min(now.dims[0], before.dims[0] - voxel[0]);
    for (int x = begin; x < end; ++x) {
      const Index<3> same_place{voxel[0] + x, voxel[1], voxel[2]};
      const float a = before.value(same_place), b = value_at(now.values, number + x);
      marks[number + x] = a != b && !(std::isnan(a) && std::isnan(b));
    }
  });
  spread_marks(marks, now.dims);
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

// Returns direct light at a texel. `radiance` is not read if maps have it, because another thread
// may fill it.
Rgb direct_at(const RadianceGrid<3>& baked, const Field<3>& field, std::size_t slot, bool back) {
  if (baked.derives_radiance(back)) {
    return baked.direct->radiance(field, baked.lattice.center(baked.lattice.active[slot]), back);
  }
  return back ? Rgb(baked.radiance_back[slot] - baked.radiance_back_indirect[slot])
              : Rgb(baked.radiance[slot] - baked.radiance_indirect[slot]);
}

// Fits all light of one side, and its indirect part, over the texels that lights reach. Takes all
// texels if lights reach none.
std::array<FittedLight, 2> fitted(const RadianceGrid<3>& baked, const Field<3>& field, bool back) {
  const TexelLattice<3>& lattice = baked.lattice;
  const Colors& indirect = back ? baked.radiance_back_indirect : baked.radiance_indirect;
  const std::size_t step = 1 + lattice.active.size() / most_fitted;
  std::array<FittedLight, 2> of_lit, of_every;
  for (std::size_t s = 0; s < lattice.active.size(); s += step) {
    const Vec3 normal = shading_normal(field, lattice.center(lattice.active[s]));
    if (normal == Vec3(0.0)) continue;
    const Rgb direct = direct_at(baked, field, s, back);
    const Vec<3, float> all = indirect[s] + Vec<3, float>(direct);
    const auto add_to = [&](std::array<FittedLight, 2>& fits) {
      fits[0].add(normal, all);
      fits[1].add(normal, indirect[s]);
    };
    add_to(of_every);
    if (largest(direct) > 0.1 * largest(Rgb(all))) add_to(of_lit);
  }
  std::array<FittedLight, 2> found = of_lit[0].is_empty() ? of_every : of_lit;
  if (!found[0].is_empty()) {
    for (FittedLight& fit : found) fit.solve();
  }
  return found;
}

// Light of a side, or its indirect part: that of a bake, its fit, and the estimate.
struct Side {
  const Colors& baked;
  FittedLight fit;
  Colors& found;
};

Index<3> nearest_voxel(const Field<3>& field, const Vec3& position) {
  Index<3> voxel;
  for (int a = 0; a < 3; ++a) {
    voxel[a] = std::clamp(static_cast<int>(std::lround(position[a])), 0, field.dims[a] - 1);
  }
  return voxel;
}

}  // namespace

RadianceGrid<3> estimated_grid(const RadianceGrid<3>& baked, const Field<3>& before,
                               const Field<3>& now, const Index<3>& resolution,
                               const IsovalueRange& isovalue_range, bool direct) {
  RadianceGrid<3> grid;
  grid.lattice = make_lattice(now, resolution, isovalue_range.min, isovalue_range.max);
  const TexelLattice<3>& lattice = grid.lattice;
  Affine<3> to_before;
  for (int a = 0; a < 3; ++a) {
    to_before.column[a] = before.world_to_index.vector(now.index_to_world.column[a]);
  }
  to_before.origin = before.world_to_index.point(now.index_to_world.origin);
  const std::vector<std::uint8_t> changed = near_changes(to_before, before, now);

  const std::size_t count = lattice.active.size();
  std::vector<Side> sides;
  const auto add_side = [&](bool back) {
    const std::array<FittedLight, 2> fits = fitted(baked, before, back);
    const auto add = [&](const Colors& light, const FittedLight& fit, Colors& found) {
      found.resize(count);
      sides.push_back({light, fit, found});
    };
    if (direct) {
      add(back ? baked.radiance_back : baked.radiance, fits[0],
          back ? grid.radiance_back : grid.radiance);
    }
    add(back ? baked.radiance_back_indirect : baked.radiance_indirect, fits[1],
        back ? grid.radiance_back_indirect : grid.radiance_indirect);
  };
  add_side(false);
  if (baked.has_back()) add_side(true);
  tbb::parallel_for(std::size_t{0}, count, [&](std::size_t s) {
    const Vec3 center = lattice.center(lattice.active[s]);
    if (changed[now.offset(nearest_voxel(now, center))]) {
      const Vec3 normal = shading_normal(now, center);
      for (const Side& side : sides) side.found[s] = side.fit.at(normal);
    } else {
      const TexelWeights<3> near = surface_weights(before, baked.lattice, to_before.point(center));
      for (const Side& side : sides) side.found[s] = mean(near, side.baked);
    }
  });
  grid.radiance_error.assign(count, std::numeric_limits<float>::quiet_NaN());
  return grid;
}

}  // namespace leaflight

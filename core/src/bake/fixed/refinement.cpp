// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/fixed/refinement.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace leaflight {
namespace {

// Cells between texels, as many as these less one along each axis.
template <int D>
Index<D> cells_of(const TexelLattice<D>& lattice) {
  Index<D> cells = lattice.resolution;
  for (int& n : cells) --n;
  return cells;
}

// The squared colours of a cell's texels about their mean, averaged, less what noise adds.
template <int D>
double variation(const RadianceLevel<D>& level, const std::vector<Vec<3, float>>& radiance,
                 const Index<D>& cell, double exposure) {
  Index<D> end = cell;
  for (int& n : end) n += 2;
  Imath::V3d sum(0), squares(0);
  double noise = 0;
  int count = 0;
  for_each_index<D>(cell, end, [&](const Index<D>& texel) {
    const std::int32_t slot = level.lattice.slot[level.lattice.linear(texel)];
    if (slot == TexelLattice<D>::inactive) return;
    for (int i = 0; i < 3; ++i) {
      const double colour = std::min(1.0, exposure * radiance[slot][i]);
      sum[i] += colour;
      squares[i] += colour * colour;
    }
    const double error = exposure * level.radiance_error[slot];
    noise += error * error;
    ++count;
  });
  if (count < 2) return 0;
  const Imath::V3d mean = sum / count, variance = squares / count - mean * mean;
  return std::max(0.0, (variance.x + variance.y + variance.z) / 3 - noise / count);
}

// The mean of |grad h| over the cell, where leaves of the window pass: dA dh = |grad h| dV.
template <int D>
double leaf_area(const Field<D>& field, const IsovalueWindow& window,
                 const TexelLattice<D>& lattice, const Index<D>& cell) {
  double sum = 0;
  for (int part = 0; part < 1 << D; ++part) {
    Vec<D> position;
    for (int a = 0; a < D; ++a) {
      position[a] = (cell[a] + (part >> a & 1 ? 0.75 : 0.25)) * lattice.voxels_per_texel[a];
    }
    const CellPoint<D> at = locate(field, position);
    const CellCorners<D> corners = load_corners(field, at.cell);
    if (!window.contains(interpolate(corners, at.local))) continue;
    sum += field.world_to_index.pull_back_gradient(geometric_gradient(corners, at.local)).length();
  }
  return sum / (1 << D);
}

template <int D>
bool any_active(const TexelLattice<D>& lattice, const Index<D>& cell) {
  Index<D> end = cell;
  for (int& n : end) n += 2;
  bool any = false;
  for_each_index<D>(cell, end, [&](const Index<D>& texel) {
    any = any || lattice.slot[lattice.linear(texel)] != TexelLattice<D>::inactive;
  });
  return any;
}

// The cells of the finest lattice in which it is looked up.
template <int D>
std::vector<char> used_cells(const RadianceGrid<D>& grid) {
  const RadianceLevel<D>& fine = grid.finest();
  const Index<D> cells = cells_of(fine.lattice);
  std::vector<char> used(cell_count<D>(cells));
  tbb::parallel_for(std::size_t{0}, used.size(), [&](std::size_t i) {
    const Index<D> cell = index_of<D>(i, cells);
    const Vec<D> middle = (to_vector<D>(cell) + Vec<D>(0.5)) * fine.lattice.voxels_per_texel;
    used[i] = any_active(fine.lattice, cell) && grid.level_at(middle) + 1 == grid.levels();
  });
  return used;
}

}  // namespace

template <int D>
std::vector<bool> cells_to_refine(const Field<D>& field, const IsovalueWindow& window,
                                  const RadianceGrid<D>& grid, double exposure) {
  const RadianceLevel<D>& from = grid.finest();
  const Index<D> cells = cells_of(from.lattice);
  const std::vector<char> used = used_cells(grid);
  std::vector<std::uint32_t> candidates;
  for (std::size_t i = 0; i < used.size(); ++i) {
    if (used[i]) candidates.push_back(static_cast<std::uint32_t>(i));
  }
  std::vector<float> scores(candidates.size());
  tbb::parallel_for(std::size_t{0}, scores.size(), [&](std::size_t i) {
    const Index<D> cell = index_of<D>(candidates[i], cells);
    double score = variation(from, from.radiance, cell, exposure);
    if (from.has_back()) score += variation(from, from.radiance_back, cell, exposure);
    if (score > 0) score *= leaf_area(field, window, from.lattice, cell);
    scores[i] = static_cast<float>(score);
  });
  std::vector<std::uint32_t> order;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    if (scores[i] > 0) order.push_back(static_cast<std::uint32_t>(i));
  }
  const auto count =
      static_cast<std::size_t>(refined_share * static_cast<double>(candidates.size()));
  if (count < order.size()) {
    // Numbers break ties, so that the choice is always the same.
    std::nth_element(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) {
                       return scores[a] != scores[b] ? scores[a] > scores[b] : a < b;
                     });
    order.resize(count);
  }
  std::vector<bool> chosen(used.size(), false);
  for (const std::uint32_t i : order) chosen[candidates[i]] = true;
  return chosen;
}

template <int D>
FinerTexels<D> finer_texels(const Field<D>& field, const IsovalueWindow& window,
                            const RadianceGrid<D>& grid, const std::vector<bool>& cells) {
  const TexelLattice<D>& coarse = grid.finest().lattice;
  const Index<D> cell_counts = cells_of(coarse);
  const Index<D> resolution = finer_resolution<D>(coarse.resolution);
  std::vector<bool> touched(cell_count<D>(resolution), false);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!cells[i]) continue;
    Index<D> low = index_of<D>(i, cell_counts), high;
    for (int a = 0; a < D; ++a) {
      low[a] *= 2;
      high[a] = low[a] + 3;
    }
    for_each_index<D>(low, high, [&](const Index<D>& texel) {
      touched[linear_number<D>(texel, resolution)] = true;
    });
  }
  // Whether all cells that a texel touches are refined, or never looked up. What finer texels do
  // not serve is looked up in coarser ones.
  const auto inside = [&](const Index<D>& texel) {
    Index<D> low, high;
    for (int a = 0; a < D; ++a) {
      low[a] = std::max((texel[a] - 1) / 2, 0);
      high[a] = std::min(texel[a] / 2 + 1, cell_counts[a]);
    }
    bool all = true;
    for_each_index<D>(low, high, [&](const Index<D>& cell) {
      const bool refined = cells[linear_number<D>(cell, cell_counts)];
      all = all && (refined || (grid.finer.empty() && !any_active(coarse, cell)));
    });
    return all;
  };
  FinerTexels<D> texels;
  texels.all = make_lattice(field, resolution, window.min, window.max, &touched);
  texels.sampled = inactive_lattice<D>(field.dims, resolution);
  std::vector<std::uint32_t> sampled;
  for (const std::uint32_t texel : texels.all.active) {
    if (inside(texels.all.texel(texel))) sampled.push_back(texel);
  }
  texels.sampled.activate(std::move(sampled));
  return texels;
}

template <int D>
RadianceLevel<D> finer_level(const RadianceGrid<D>& coarse, FinerTexels<D> texels,
                             const RadianceLevel<D>& sampled) {
  RadianceLevel<D> level;
  level.lattice = std::move(texels.all);
  for (const std::uint32_t texel : level.lattice.active) {
    const std::int32_t slot = texels.sampled.slot[texel];
    if (slot != TexelLattice<D>::inactive) {
      level.radiance.push_back(sampled.radiance[slot]);
      level.radiance_indirect.push_back(sampled.radiance_indirect[slot]);
      level.radiance_error.push_back(sampled.radiance_error[slot]);
      if (coarse.has_back()) {
        level.radiance_back.push_back(sampled.radiance_back[slot]);
        level.radiance_back_indirect.push_back(sampled.radiance_back_indirect[slot]);
      }
      continue;
    }
    const Vec<D> position = level.lattice.centre(texel);
    const RadianceLevel<D>& from = coarse.at(position);
    level.radiance.push_back(lookup(from.lattice, from.radiance, position));
    level.radiance_indirect.push_back(lookup(from.lattice, from.radiance_indirect, position));
    level.radiance_error.push_back(lookup_error(from.lattice, from.radiance_error, position));
    if (coarse.has_back()) {
      level.radiance_back.push_back(lookup(from.lattice, from.radiance_back, position));
      level.radiance_back_indirect.push_back(
          lookup(from.lattice, from.radiance_back_indirect, position));
    }
  }
  return level;
}

template std::vector<bool> cells_to_refine<2>(const Field<2>&, const IsovalueWindow&,
                                              const RadianceGrid<2>&, double);
template std::vector<bool> cells_to_refine<3>(const Field<3>&, const IsovalueWindow&,
                                              const RadianceGrid<3>&, double);
template FinerTexels<2> finer_texels<2>(const Field<2>&, const IsovalueWindow&,
                                        const RadianceGrid<2>&, const std::vector<bool>&);
template FinerTexels<3> finer_texels<3>(const Field<3>&, const IsovalueWindow&,
                                        const RadianceGrid<3>&, const std::vector<bool>&);
template RadianceLevel<2> finer_level<2>(const RadianceGrid<2>&, FinerTexels<2>,
                                         const RadianceLevel<2>&);
template RadianceLevel<3> finer_level<3>(const RadianceGrid<3>&, FinerTexels<3>,
                                         const RadianceLevel<3>&);

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#include "transport/isosurface_cache.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace leaflight {
namespace {

constexpr double indirect_photons_per_box = 100, caustic_photons_per_box = 30;
constexpr int largest_indirect_radius = 4, largest_caustic_radius = 2;
// Points per texel and axis at which |grad h| is evaluated. A texel only partly in the isovalue
// range uses more, because a cap fills it with a thin layer.
constexpr int measure_points = 2, finer_measure_points = 4;

// Returns the share of the values within `reach` of c that is in the isovalue range. Points alone
// would miss a range that is narrower than the change of h between two points.
double share_in_range(const IsovalueRange& isovalue_range, double c, double reach) {
  if (!(reach > 0)) return isovalue_range.contains(c);
  const double low = std::max(isovalue_range.min, c - reach),
               high = std::min(isovalue_range.max, c + reach);
  return std::max(0.0, high - low) / (2 * reach);
}

// Mean of |grad h| over the part of a texel's box in the isovalue range.
struct MeanGradient {
  double value = 0;
  bool is_complete = true;  // true if all of the box is in the isovalue range
};
template <int D>
MeanGradient mean_gradient(const Volume<D>& volume, const IsovalueRange& isovalue_range,
                           const TexelLattice<D>& lattice, std::uint32_t texel,
                           const Affine<D>& frame_to_index, int points) {
  const Field<D>& field = volume.field;
  const Index<D> index = lattice.texel(texel);
  Index<D> none{}, all;
  all.fill(points);
  MeanGradient mean;
  for_each_index<D>(none, all, [&](const Index<D>& part) {
    Vec<D> position;
    for (int a = 0; a < D; ++a) {
      position[a] = (index[a] + (part[a] + 0.5) / points - 0.5) * lattice.voxels_per_texel[a];
    }
    const CellPoint<D> point = locate(field, position);
    const CellCorners<D> corners = load_corners(field, point.cell);
    const double h = interpolate(corners, point.local);
    // Masked cells contain no isosurface.
    if (!inside(field, position) || std::isnan(h)) {
      mean.is_complete = false;
      return;
    }
    const Vec<D> gradient = geometric_gradient(corners, point.local);
    double reach = 0;
    for (int a = 0; a < D; ++a) {
      reach += std::abs(gradient[a]) * lattice.voxels_per_texel[a] / (2 * points * volume.scale);
    }
    const double share = share_in_range(isovalue_range, volume.common_isovalue(h), reach);
    mean.is_complete = mean.is_complete && share == 1;
    mean.value += share * frame_to_index.pull_back_gradient(gradient).length();
  });
  mean.value /= static_cast<double>(cell_count<D>(all));
  return mean;
}

// Integrates |grad c| over the part of a texel's box in the isovalue range, in the frame. Heights
// are in units of the isovalue range.
template <int D>
float coarea_measure(const Volume<D>& volume, const IsovalueRange& isovalue_range,
                     const TexelLattice<D>& lattice, std::uint32_t texel,
                     const Affine<D>& frame_to_index, double texel_volume) {
  MeanGradient mean =
      mean_gradient(volume, isovalue_range, lattice, texel, frame_to_index, measure_points);
  if (!mean.is_complete) {
    mean =
        mean_gradient(volume, isovalue_range, lattice, texel, frame_to_index, finer_measure_points);
  }
  return static_cast<float>(mean.value * texel_volume / volume.scale / isovalue_range.height());
}

// Computes running sums over 2 radius + 1 values along one axis of a dense grid, with zeros
// outside.
template <int D>
void box_sum(std::vector<float>& grid, const Index<D>& dims, int axis, int radius,
             Progress& progress) {
  std::size_t stride = 1;
  for (int a = 0; a < axis; ++a) stride *= dims[a];
  const int n = dims[axis];
  const std::size_t lines = grid.size() / n;
  parallel_range(lines, 256, 0, progress, [&](std::size_t begin, std::size_t end) {
    std::vector<double> prefix(n + 1, 0.0);
    for (std::size_t line = begin; line < end; ++line) {
      float* first = grid.data() + (line / stride) * stride * n + line % stride;
      for (int i = 0; i < n; ++i) prefix[i + 1] = prefix[i] + first[i * stride];
      for (int i = 0; i < n; ++i) {
        first[i * stride] = static_cast<float>(prefix[std::min(n, i + radius + 1)] -
                                               prefix[std::max(0, i - radius)]);
      }
    }
  });
}

// Computes, for each active texel, the sum of a quantity over the active texels in a box around it.
template <int D, class Value>
std::vector<float> smooth(const TexelLattice<D>& lattice, int radius, Progress& progress,
                          Value value) {
  std::vector<float> grid(lattice.texels(), 0.0f);
  for (std::size_t s = 0; s < lattice.active.size(); ++s) {
    grid[lattice.active[s]] = value(s);
  }
  for (int axis = 0; axis < D && radius > 0; ++axis) {
    box_sum<D>(grid, lattice.resolution, axis, radius, progress);
  }
  std::vector<float> sums(lattice.active.size());
  for (std::size_t s = 0; s < sums.size(); ++s) sums[s] = grid[lattice.active[s]];
  return sums;
}

}  // namespace

template <int D>
IsosurfaceCache<D>::IsosurfaceCache(const SceneTracer<D>& tracer, int volume,
                                    const TexelLattice<D>& lattice, SideContents back,
                                    bool variance, bool caustics, double photon_flux,
                                    std::uint64_t photons)
    : tracer_(tracer), volume_(volume), lattice_(lattice) {
  sides_[0].contents = SideContents::indirect;
  sides_[1].contents = back;
  for (Side& side : sides_) {
    if (side.contents == SideContents::nothing) continue;
    const std::size_t texels = lattice.active.size();
    side.indirect.flux = FluxAccumulator(texels, photon_flux, photons, variance);
    if (caustics) side.caustic.flux = FluxAccumulator(texels, photon_flux, photons, variance);
  }
}

template <int D>
void IsosurfaceCache<D>::deposit(const PhotonHit<D>& photon) {
  Side& side = sides_[photon.point.isosurface().back];
  if (side.contents == SideContents::nothing) return;
  if (photon.arrival == Arrival::direct && side.contents == SideContents::indirect) return;
  const bool is_caustic = photon.arrival == Arrival::caustic && !side.caustic.flux.empty();
  Density& density = is_caustic ? side.caustic : side.indirect;
  const std::int32_t slot =
      lattice_.nearest_slot(photon.point.isosurface().cell_point.index_position());
  if (slot == TexelLattice<D>::inactive) return;
  density.flux.add(slot, photon.flux_height);
  density.stored.fetch_add(1, std::memory_order_relaxed);
}

template <int D>
int IsosurfaceCache<D>::radius_for(double photons, std::size_t texels, double photons_per_box,
                                   int largest) const {
  const double per_texel = photons / static_cast<double>(std::max<std::size_t>(1, texels));
  const double width = std::pow(photons_per_box / std::max(per_texel, 1e-9), 1.0 / D);
  return std::clamp(static_cast<int>(std::ceil((width - 1) / 2)), 0, largest);
}

template <int D>
void IsosurfaceCache<D>::estimate(Density& density, int radius, const std::vector<float>& measure,
                                  Progress& progress) {
  const std::size_t n = lattice_.active.size();
  const std::vector<float> area =
      smooth(lattice_, radius, progress, [&](std::size_t s) { return measure[s]; });
  density.irradiance.assign(n, Rgb(0));
  for (int channel = 0; channel < 3; ++channel) {
    const std::vector<float> sums = smooth(lattice_, radius, progress, [&](std::size_t s) {
      return static_cast<float>(density.flux.flux(s, channel));
    });
    for (std::size_t s = 0; s < n; ++s) {
      density.irradiance[s][channel] = area[s] > 0 ? sums[s] / area[s] : 0;
    }
  }
  if (density.flux.has_variance()) {
    density.variance = smooth(lattice_, radius, progress, [&](std::size_t s) {
      return static_cast<float>(density.flux.variance(s));
    });
    for (std::size_t s = 0; s < n; ++s) density.variance[s] /= area[s] > 0 ? area[s] * area[s] : 1;
  }
  density.flux = FluxAccumulator(0, 1, 1);
}

template <int D>
void IsosurfaceCache<D>::finish(Progress& progress) {
  const std::size_t n = lattice_.active.size();
  const Affine<D> frame_to_index = inverse(tracer_.index_to_frame(volume_));
  double texel_volume = std::abs(determinant(tracer_.index_to_frame(volume_)));
  for (int a = 0; a < D; ++a) texel_volume *= lattice_.voxels_per_texel[a];
  const Scene<D>& scene = tracer_.scene();
  std::vector<float> measure(n);
  parallel_each(n, 1024, progress, [&](std::size_t s) {
    measure[s] = coarea_measure(scene.volumes[volume_], scene.isovalue_range, lattice_,
                                lattice_.active[s], frame_to_index, texel_volume);
  });
  // Both sides use the radius of the front's photons.
  const int radius = radius_for(static_cast<double>(sides_[0].indirect.stored.load()), n,
                                indirect_photons_per_box, largest_indirect_radius);
  for (Side& side : sides_) {
    if (!side.indirect.flux.empty()) estimate(side.indirect, radius, measure, progress);
    if (side.caustic.flux.empty() || side.caustic.stored.load() == 0) continue;
    // Caustics light only a part of the isosurfaces; the radius depends on their density there.
    std::size_t lit_texels = 0;
    for (std::size_t s = 0; s < n; ++s) lit_texels += side.caustic.flux.lit(s);
    const int sharp = radius_for(static_cast<double>(side.caustic.stored.load()), lit_texels,
                                 caustic_photons_per_box, largest_caustic_radius);
    estimate(side.caustic, sharp, measure, progress);
  }
}

template class IsosurfaceCache<2>;
template class IsosurfaceCache<3>;

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/direct/direct_light.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "base/sampling.h"
#include "field/shading_gradient.h"

namespace leaflight {
namespace {

// Limits for the maps of one side. The last two hold for maps that are finer than voxels.
constexpr std::size_t most_bytes = std::size_t{512} << 20, most_finer_bytes = 24 << 20,
                      most_fine_texels = 8'000'000;

// The gradient of the interpolated surface jumps at cell faces, on which meshes have their
// vertices. Within this distance in voxels, it blends into the shading gradient, the mean across
// the face.
constexpr double near_face = 0.05;

template <int D>
Vec<D> surface_gradient(const CellCorners<D>& corners, const Vec<D>& local, const Vec<D>& shading) {
  Vec<D> gradient = geometric_gradient(corners, local);
  for (int a = 0; a < D; ++a) {
    const double weight = std::min(1.0, std::min(local[a], 1 - local[a]) / near_face);
    gradient[a] = shading[a] + (gradient[a] - shading[a]) * weight;
  }
  return gradient;
}

}  // namespace

template <int D>
IsosurfacePoint<D> isosurface_point(const Field<D>& field, const Vec<D>& index_position) {
  const CellPoint<D> at = locate(field, index_position);
  const CellCorners<D> corners = load_corners(field, at.cell);
  return {index_position, at, corners, interpolate(corners, at.local), shading_gradient(field, at)};
}

template <int D>
Index<D> map_resolution(const Field<D>& field, const IsovalueRange& isovalue_range,
                        const Index<D>& texels, std::size_t points) {
  const auto fits = [&](const Index<D>& resolution, std::size_t most) {
    return cell_count<D>(resolution) * points <= most ||
           active_texels(field, resolution, isovalue_range.min, isovalue_range.max) * points <=
               most;
  };
  Index<D> found;
  for (int a = 0; a < D; ++a) found[a] = std::min(field.dims[a], texels[a]);
  if (found != texels && cell_count<D>(texels) <= most_fine_texels &&
      fits(texels, most_finer_bytes)) {
    return texels;
  }
  return fits(found, most_bytes) ? found : coarser_resolution<D>(found, 2);
}

template <int D>
DirectLight<D>::DirectLight(const SceneTracer<D>& tracer, int volume,
                            const std::vector<LightPoint<D>>& points)
    : isovalue_range_(tracer.scene().volumes[volume].isovalues(tracer.scene().isovalue_range)),
      albedo_(tracer.scene().volumes[volume].albedo),
      emission_(tracer.scene().volumes[volume].emission),
      offset_(tracer.scene().volumes[volume].offset),
      scale_(tracer.scene().volumes[volume].scale),
      has_smooth_normals_(tracer.scene().volumes[volume].field.has_smooth_normals()),
      to_frame_(tracer.index_to_frame(volume)),
      to_index_(inverse(to_frame_)),
      points_(points) {
  fill_blocks();
}

template <int D>
DirectLight<D>::DirectLight(const SceneTracer<D>& tracer, int volume,
                            const std::vector<LightPoint<D>>& points,
                            const MapSettings<D>& settings, Progress& progress,
                            const DirectLight* earlier)
    : DirectLight(tracer, volume, points) {
  auto maps = std::make_shared<Maps>();
  maps->lattice = map_lattice(tracer.scene(), volume, settings.resolution);
  MapSweeps<D> sweeps(tracer, volume, points_, maps->lattice,
                      earlier ? earlier->lattice() : maps->lattice, settings.spacing);
  code_range_ = sweeps.code_range();
  std::vector<int> known(points_.size(), -1);
  if (earlier) known = same_points(points_, earlier->points_);
  std::vector<std::vector<std::size_t>> groups;  // points whose maps are unknown
  for (std::size_t i = 0; i < known.size(); ++i) {
    if (known[i] >= 0) continue;
    if (groups.empty() || groups.back().size() == MapSweeps<D>::points_at_once) {
      groups.emplace_back();
    }
    groups.back().push_back(i);
  }
  const bool reuses =
      std::any_of(known.begin(), known.end(), [](int number) { return number >= 0; });
  for (int side = 0; side < (settings.back ? 2 : 1); ++side) {
    const bool back = side != 0;
    // radiance() reads whole blocks.
    maps->codes[back].resize(maps->lattice.active.size() * points_.size() + block);
    for (const std::vector<std::size_t>& group : groups) {
      put(sweeps.codes(group, back, progress), group, back, *maps, progress);
    }
    if (reuses) take(*earlier, known, back, *maps, progress);
    summarize(back, *maps, progress);
  }
  maps_ = std::move(maps);
}

template <int D>
void DirectLight<D>::put(const PointCodes& codes, const std::vector<std::size_t>& numbers,
                         bool back, Maps& maps, Progress& progress) const {
  const std::size_t count = points_.size(), some = numbers.size();
  parallel_each(maps.lattice.active.size(), 4096, progress, [&](std::size_t s) {
    for (std::size_t i = 0; i < some; ++i) {
      maps.codes[back][s * count + numbers[i]] = codes[s * some + i];
    }
  });
}

template <int D>
void DirectLight<D>::take(const DirectLight& earlier, const std::vector<int>& numbers, bool back,
                          Maps& maps, Progress& progress) const {
  const std::size_t count = points_.size();
  parallel_each(maps.lattice.active.size(), 4096, progress, [&](std::size_t s) {
    const std::int32_t slot =
        nearest_active_slot(earlier.lattice(), maps.lattice.center(maps.lattice.active[s]));
    if (slot == TexelLattice<D>::inactive) return;
    for (std::size_t i = 0; i < count; ++i) {
      if (numbers[i] >= 0) maps.codes[back][s * count + i] = earlier.code(numbers[i], slot, back);
    }
  });
}

template <int D>
void DirectLight<D>::summarize(bool back, Maps& maps, Progress& progress) const {
  const std::size_t count = points_.size(), active = maps.lattice.active.size();
  std::atomic<bool> any_dark{maps.has_dark};
  maps.least[back].assign(active, VisibilityCode::dark);
  parallel_each(active, 4096, progress, [&](std::size_t s) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint8_t code = maps.codes[back][s * count + i];
      maps.least[back][s] = std::min(maps.least[back][s], code);
      if (code == VisibilityCode::dark) any_dark = true;
    }
  });
  maps.has_dark = any_dark;
}

template <int D>
DirectLight<D> DirectLight<D>::scaled(const std::vector<Rgb>& lights) const {
  DirectLight<D> result = *this;
  scale_points(lights, result.points_);
  result.fill_blocks();
  return result;
}

template <int D>
float DirectLight<D>::greatest(std::size_t point, const TexelWeights<D>& near, bool back) const {
  float sum = 0;
  for (int i = 0; i < near.count; ++i) {
    sum += near.weight[i] * maps_->codes[back][near.slot[i] * points_.size() + point];
  }
  return sum;
}

template <int D>
void DirectLight<D>::fill_blocks() {
  blocks_.assign((points_.size() + block - 1) / block, Block{});
  for (Block& points : blocks_) {
    for (Row& row : points.at) row.fill(1);
  }
  for (std::size_t n = 0; n < points_.size(); ++n) {
    const LightSource<D>& source = points_[n].source;
    Block& points = blocks_[n / block];
    const std::size_t k = n % block;
    points.near[k] = source.infinite ? 0 : 1;
    const bool even = source.infinite || source.sphere;
    (even ? points.even : source.both_sides ? points.both : points.front)[k] = 1;
    for (int a = 0; a < D; ++a) {
      points.at[a][k] =
          static_cast<float>(source.infinite ? -source.direction[a] : source.position[a]);
      if (!even) points.normal[a][k] = static_cast<float>(source.normal[a]);
    }
    for (int i = 0; i < 3; ++i) points.amount[i][k] = static_cast<float>(source.amount[i]);
    if (source.cone) points.cones.push_back(static_cast<int>(k));
  }
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    bound(blocks_[b], b * block, std::min(points_.size(), (b + 1) * block));
  }
}

template <int D>
void DirectLight<D>::bound(Block& points, std::size_t first, std::size_t end) const {
  Box<D> box;
  for (std::size_t n = first; n < end; ++n) {
    const LightSource<D>& source = points_[n].source;
    if (source.infinite) {
      points.radius = std::numeric_limits<float>::infinity();
      return;
    }
    box.extend(source.position);
  }
  points.center = Vec<D, float>((box.low + box.high) * 0.5);
  points.radius = static_cast<float>((box.high - box.low).length() * 0.5);
}

// True if no point lights an isosurface of code `own`, for any weights of the texels.
template <int D>
bool DirectLight<D>::is_dark(const TexelWeights<D>& near, bool back, float code) const {
  for (int i = 0; i < near.count; ++i) {
    if (code >= static_cast<float>(maps_->least[back][near.slot[i]]) - 1) return false;
  }
  return true;
}

template <int D>
typename DirectLight<D>::Shadows DirectLight<D>::shadows(std::size_t number,
                                                         const TexelWeights<D>& near,
                                                         bool back) const {
  const std::uint8_t* maps = maps_->codes[back].data() + number * block;
  Shadows found;
  for (int i = 0; i < near.count; ++i) {
    const float w = near.weight[i];
    const std::uint8_t* codes = maps + near.slot[i] * points_.size();
    if (!maps_->has_dark) {
      for (int k = 0; k < block; ++k) found.greatest[k] += w * static_cast<float>(codes[k]);
      continue;
    }
    for (int k = 0; k < block; ++k) {
      // A mesh's shadow ends halfway between the texels on either side of its edge.
      const float is_dark = codes[k] == VisibilityCode::dark ? w : 0.0f;
      found.dark[k] += is_dark;
      found.greatest[k] += (w - is_dark) * static_cast<float>(codes[k]);
    }
  }
  return found;
}

template <int D>
typename DirectLight<D>::Row DirectLight<D>::arriving(const Block& points, const Receiver& at,
                                                      const Shadows& shadows, float code) {
  Row distance2{}, cosine{}, facing{}, leaving{}, share;
  for (int a = 0; a < D; ++a) {
    const float from = at.position[a], normal = at.normal[a], geometric = at.geometric_normal[a];
    for (int k = 0; k < block; ++k) {
      const float toward = from * points.near[k] - points.at[a][k];
      distance2[k] += toward * toward;
      cosine[k] -= toward * normal;
      facing[k] -= toward * geometric;
      leaving[k] += toward * points.normal[a][k];
    }
  }
  const Row &greatest = shadows.greatest, &dark = shadows.dark;
  for (int k = 0; k < block; ++k) {
    const float per_distance = 1 / std::sqrt(distance2[k]);
    const float from_light = leaving[k] * per_distance;
    const float front = from_light > 0 ? from_light : 0.0f;
    const float strength =
        points.even[k] + points.front[k] * front + points.both[k] * std::abs(from_light);
    const float spreads = D == 3 ? per_distance * per_distance : per_distance;
    const float light = strength * spreads * cosine[k] * per_distance;
    const float shown = greatest[k] < code * (1 - dark[k]) ? light : 0.0f;
    const float unhidden = dark[k] < 0.5f ? shown : 0.0f;
    const float faced = facing[k] > 0 ? unhidden : 0.0f;
    share[k] = cosine[k] > 0 ? faced : 0.0f;
  }
  return share;
}

template <int D>
Rgb DirectLight<D>::radiance(const IsosurfacePoint<D>& point, const TexelWeights<D>& near,
                             bool back) const {
  const double h = point.value;
  if (std::isnan(h)) return Rgb(0);
  const float code = VisibilityCode{code_range_, back}(h);
  if (is_dark(near, back, code)) return Rgb(0);
  // The back faces higher values.
  const Vec<D> gradient = to_index_.pull_back_gradient(point.gradient);
  const double length = gradient.length();
  if (!(length > 0)) return Rgb(0);
  const double outward = (back ? 1 : -1) / length;
  const Vec<D> surface = has_smooth_normals_ ? gradient
                                             : to_index_.pull_back_gradient(surface_gradient(
                                                   point.corners, point.at.local, point.gradient));
  // Transform the point and its normals to the frame.
  const Vec<D> place = to_frame_.point(point.position);
  const Receiver receiver{Vec<D, float>(place), Vec<D, float>(gradient * outward),
                          Vec<D, float>(surface * outward)};
  std::array<float, 3> irradiance{};
  // Add the light of each block of points that is not in shadow.
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    const Block& points = blocks_[b];
    if (points.is_behind(receiver)) continue;
    const Shadows in_shadow = shadows(b, near, back);
    if (!in_shadow.any_lit(code)) continue;
    Row share = arriving(points, receiver, in_shadow, code);
    for (const int k : points.cones) {
      if (!(share[k] > 0)) continue;
      const LightSource<D>& source = points_[b * block + k].source;
      share[k] *= static_cast<float>(source.cone->share((place - source.position).normalized()));
    }
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < block; ++k) irradiance[i] += share[k] * points.amount[i][k];
    }
  }
  const Rgb sum(irradiance[0], irradiance[1], irradiance[2]);
  return sum * albedo_.at((h - offset_) / scale_) / static_cast<Real>(projected_hemisphere<D>);
}

template <int D>
Rgb DirectLight<D>::emission(const Field<D>& field, const Vec<D>& index_position) const {
  const CellPoint<D> at = locate(field, index_position);
  const double h = interpolate(load_corners(field, at.cell), at.local);
  return std::isnan(h) ? Rgb(0) : emission_.at((h - offset_) / scale_);
}

template IsosurfacePoint<2> isosurface_point<2>(const Field<2>&, const Vec<2>&);
template IsosurfacePoint<3> isosurface_point<3>(const Field<3>&, const Vec<3>&);
template Index<2> map_resolution<2>(const Field<2>&, const IsovalueRange&, const Index<2>&,
                                    std::size_t);
template Index<3> map_resolution<3>(const Field<3>&, const IsovalueRange&, const Index<3>&,
                                    std::size_t);
template class DirectLight<2>;
template class DirectLight<3>;

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "bake/direct/map_sweeps.h"
#include "bake/direct/stored_maps.h"
#include "base/box.h"
#include "transport/light_points.h"

namespace leaflight {

// A point with the isosurface through it, as texels and direct light need it.
template <int D>
struct IsosurfacePoint {
  Vec<D> position;  // in index coordinates
  CellPoint<D> at;
  CellCorners<D> corners;
  double value;     // value of the field; NaN in masked cells
  Vec<D> gradient;  // shading gradient, in index coordinates
};
template <int D>
IsosurfacePoint<D> isosurface_point(const Field<D>& field, const Vec<D>& index_position);

// Direct light of a scene's light points on all isosurfaces of a volume. Visibility maps hold, for
// each texel and light point, the greatest value between the two. Isosurfaces of lower isovalues
// are in shadow there. For backs, the maps hold the least value, and isosurfaces of higher
// isovalues are in shadow. Cosine and distance are exact at each shaded point. Nothing is averaged
// or random.
template <int D>
class DirectLight {
 public:
  // Computes the maps of one volume. An `earlier` light is that of the same scene under other
  // lights. Its maps are reused for points that have not moved. The result does not depend on the
  // number of threads. It does not depend on `earlier`, if the texels of that have the same width.
  // Throws Cancelled.
  DirectLight(const SceneTracer<D>& tracer, int volume, const std::vector<LightPoint<D>>& points,
              const MapSettings<D>& settings, Progress& progress,
              const DirectLight* earlier = nullptr);

  // Restores the light of stored() maps, of the same scene. Throws std::runtime_error if they are
  // damaged.
  DirectLight(const SceneTracer<D>& tracer, int volume, const std::vector<LightPoint<D>>& points,
              const StoredMaps<D>& maps);
  StoredMaps<D> stored() const;

  // Returns the same light with one factor per channel for each light of the scene. Shares the
  // maps.
  DirectLight scaled(const std::vector<Rgb>& lights) const;

  // Returns the texels of the maps.
  const TexelLattice<D>& lattice() const { return maps_->lattice; }
  std::size_t points() const { return points_.size(); }
  const LightPoint<D>& point(std::size_t number) const { return points_[number]; }
  const Affine<D>& index_to_frame() const { return to_frame_; }
  // Returns the isovalue range in values of the field.
  const IsovalueRange& isovalue_range() const { return isovalue_range_; }
  // Returns the range of the codes in values of the field.
  const IsovalueRange& code_range() const { return code_range_; }
  bool has_back() const { return !maps_->codes[1].empty(); }
  // Returns the VisibilityCode between an active texel and a light point.
  std::uint8_t code(std::size_t point, std::size_t slot, bool back) const {
    return maps_->codes[back][slot * points_.size() + point];
  }

  // Computes the radiance [W/(m^2 sr)] that an isosurface reflects on one of its sides. Returns
  // zero where no isosurface passes. The field must be that of the volume. `near`: the position's
  // weights in lattice().
  Rgb radiance(const IsosurfacePoint<D>& point, const TexelWeights<D>& near, bool back) const;
  Rgb radiance(const Field<D>& field, const Vec<D>& index_position, bool back) const {
    return radiance(isosurface_point(field, index_position),
                    linear_weights(lattice(), index_position), back);
  }
  // Prefetches the part of the maps that radiance() will read.
  void prefetch(const TexelWeights<D>& near, bool back) const {
    for (int i = 0; i < near.count; ++i) {
      const auto slot = static_cast<std::size_t>(near.slot[i]);
      __builtin_prefetch(&maps_->least[back][slot]);
      __builtin_prefetch(&maps_->codes[back][slot * points_.size()]);
    }
  }
  // Returns the emission of the isosurface [W/(m^2 sr)].
  Rgb emission(const Field<D>& field, const Vec<D>& index_position) const;
  // Interpolates the greatest code between a position and a light point. `near`: the position's
  // weights in lattice().
  float greatest(std::size_t point, const TexelWeights<D>& near, bool back) const;

 private:
  // Number of points in a block; one SIMD instruction handles several of them.
  static constexpr int block = 8;
  using Row = std::array<float, static_cast<std::size_t>(block)>;
  // A position in the frame, and its normals on the lit side.
  struct Receiver {
    Vec<D, float> position, normal, geometric_normal;
  };
  // Rounding error of a length in single precision, relative.
  static constexpr float rounding = 1e-5f;
  // A block of points as arrays, padded with dark points. The vector from a point to x in the frame
  // is x * near - at. Its strength is the sum of three terms: `even`, `front` times the positive
  // part of the cosine to `normal`, and `both` times the absolute cosine.
  struct Block {
    std::array<Row, D> at{}, normal{};
    Row near{}, even{}, front{}, both{};
    std::array<Row, 3> amount{};
    std::vector<int> cones;  // points with a cone
    // A ball in the frame that contains the points; infinite for lights at infinity.
    Vec<D, float> center{0.0f};
    float radius = 0;

    // True if all points lie below the horizon of a receiver.
    bool is_behind(const Receiver& seen) const {
      const Vec<D, float> to_center = center - seen.position;
      return to_center.dot(seen.normal) + radius < -rounding * to_center.length();
    }
  };
  // For each point of a block, the greatest code on the way and the weight of a mesh's shadow.
  struct Shadows {
    Row greatest{}, dark{};

    // True if any point lights an isosurface of code `own`.
    bool any_lit(float code) const {
      bool any = false;
      for (int k = 0; k < block; ++k) any |= greatest[k] < code;
      return any;
    }
  };
  struct Maps;
  DirectLight(const SceneTracer<D>& tracer, int volume, const std::vector<LightPoint<D>>& points);
  // Stores the codes of the points with these numbers.
  void put(const PointCodes& codes, const std::vector<std::size_t>& numbers, bool back, Maps& maps,
           Progress& progress) const;
  // Copies codes from an earlier DirectLight. `numbers`: each point's number there, or -1.
  void take(const DirectLight& earlier, const std::vector<int>& numbers, bool back, Maps& maps,
            Progress& progress) const;
  // Computes the least code of each texel, and has_dark.
  void summarize(bool back, Maps& maps, Progress& progress) const;
  void fill_blocks();
  // Computes the bounding ball of points [first, end).
  void bound(Block& points, std::size_t first, std::size_t end) const;
  bool is_dark(const TexelWeights<D>& near, bool back, float code) const;
  Shadows shadows(std::size_t number, const TexelWeights<D>& near, bool back) const;
  // Computes the irradiance at a receiver of code `own` from each point of a block, divided by the
  // point's amount. Ignores cones.
  static Row arriving(const Block& points, const Receiver& at, const Shadows& shadows, float code);

  IsovalueRange isovalue_range_, code_range_;  // in values of the field
  ColorRamp albedo_, emission_;
  double offset_, scale_;  // isovalue = offset + scale c
  // True if shading normals alone decide which side faces a light. The steps of integer values
  // would stay dark otherwise (docs/decisions/volumes.md).
  bool has_smooth_normals_;
  Affine<D> to_frame_, to_index_;
  std::vector<LightPoint<D>> points_;
  std::vector<Block> blocks_;
  struct Maps {
    TexelLattice<D> lattice;
    // One array per side; its index is slot * points + point.
    std::array<std::vector<std::uint8_t>, 2> codes;
    // The least code of each texel. Isosurfaces of lower codes lie in the shadow of all points.
    std::array<std::vector<std::uint8_t>, 2> least;
    bool has_dark = false;  // true if a mesh casts shadows into the volume
  };
  std::shared_ptr<const Maps> maps_;
};

// Returns the resolution of the maps for a bake of `texels` along each axis. It is that of the bake
// if the maps then take at most 24 MB. Otherwise it is the coarser of the field's and the bake's,
// or half of that if the maps would exceed 512 MB. `isovalue_range`: in values of the field.
template <int D>
Index<D> map_resolution(const Field<D>& field, const IsovalueRange& isovalue_range,
                        const Index<D>& texels, std::size_t points);

// Returns the memory of the maps of one side.
template <int D>
std::size_t map_bytes(const Field<D>& field, const IsovalueRange& isovalue_range,
                      const Index<D>& texels, std::size_t points) {
  const Index<D> resolution = map_resolution(field, isovalue_range, texels, points);
  return active_texels(field, resolution, isovalue_range.min, isovalue_range.max) * (points + 1);
}

}  // namespace leaflight

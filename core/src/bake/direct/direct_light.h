// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "bake/direct/visibility_through.h"
#include "math/box.h"
#include "transport/light_points.h"

namespace leaflight {

// A point of the isosurface through it, which the texels and the direct light there both need.
template <int D>
struct IsosurfacePoint {
  Vec<D> position;  // in index coordinates
  CellPoint<D> at;
  CellCorners<D> corners;
  double value;     // of the field, NaN where there is no data
  Vec<D> gradient;  // of shading, in index coordinates
};
template <int D>
IsosurfacePoint<D> isosurface_point(const Field<D>& field, const Vec<D>& index_position);

// Direct light of a scene's light points at any point of any isosurface of a volume, computed where
// it is shown: the cosine and the distance are those of the point itself. For each texel and light
// point it stores the greatest value on the way: the isosurface of a lower isovalue is in shadow
// there (for backs the least value). Nothing of it is averaged or random.
template <int D>
class DirectLight {
 public:
  // Of a map, for the progress, in points of lines.
  static constexpr double work_of_texel = 0.2;

  // Of a volume by its number; `resolution`: of the maps; `back`: of the backs, too, which
  // needs the scene's only volume; `spacing`: as VisibilitySweep has it; `earlier`: where lights
  // alone were others, whose maps serve for the points that have not moved. The result is the same
  // for any number of threads, and where the maps have texels as wide, with `earlier` or without.
  // Throws Cancelled.
  DirectLight(const SceneTracer<D>& tracer, int volume, const std::vector<LightPoint<D>>& points,
              const Index<D>& resolution, bool back, Progress& progress, double spacing = 1,
              const DirectLight* earlier = nullptr);

  // With other strengths of the scene's lights: a factor per channel for each. Shares the maps.
  DirectLight scaled(const std::vector<Rgb>& lights) const;

  // Texels of the maps.
  const TexelLattice<D>& lattice() const { return maps_->lattice; }
  std::size_t points() const { return points_.size(); }
  const LightPoint<D>& point(std::size_t number) const { return points_[number]; }
  const Affine<D>& index_to_frame() const { return to_frame_; }
  // Of the field's values.
  const IsovalueRange& isovalue_range() const { return isovalue_range_; }
  // That of the codes.
  const IsovalueRange& code_range() const { return code_range_; }
  bool has_back() const { return !maps_->codes[1].empty(); }
  // VisibilityCode of the way from an active texel to a point.
  std::uint8_t code(std::size_t point, std::size_t slot, bool back) const {
    return maps_->codes[back][slot * points_.size() + point];
  }

  // Radiance [W/(m^2 sr)] that the isosurface through an index position of the field, which must be
  // that of the volume, reflects on one of its sides; zero where no isosurface passes.
  // `near`: the position's weights in lattice().
  Rgb radiance(const IsosurfacePoint<D>& point, const TexelWeights<D>& near, bool back) const;
  Rgb radiance(const Field<D>& field, const Vec<D>& index_position, bool back) const {
    return radiance(isosurface_point(field, index_position),
                    linear_weights(lattice(), index_position), back);
  }
  // Has what radiance() will read of the maps brought from memory.
  void prefetch(const TexelWeights<D>& near, bool back) const {
    for (int i = 0; i < near.count; ++i) {
      const auto slot = static_cast<std::size_t>(near.slot[i]);
      __builtin_prefetch(&maps_->least[back][slot]);
      __builtin_prefetch(&maps_->codes[back][slot * points_.size()]);
    }
  }
  // What the isosurface emits by itself, [W/(m^2 sr)].
  Rgb emission(const Field<D>& field, const Vec<D>& index_position) const;
  // The greatest code on the way to a point from where a position has these weights in lattice().
  float greatest(std::size_t point, const TexelWeights<D>& near, bool back) const;

 private:
  // Points are taken so many at a time, by instructions that do the same for several.
  static constexpr int block = 8;
  using Row = std::array<float, static_cast<std::size_t>(block)>;
  // A place in the frame, and its normals on the side that is lit.
  struct Receiver {
    Vec<D, float> position, normal, geometric_normal;
  };
  // Of lengths, in single precision.
  static constexpr float rounding = 1e-5f;
  // A block of points as numbers, filled up with dark ones. From a position x of the frame the way
  // from a point is x * near - at; its strength is the sum of `even`, of `front` times the cosine
  // to `normal` where that is positive, and of `both` times its absolute value.
  struct Block {
    std::array<Row, D> at{}, normal{};
    Row near{}, even{}, front{}, both{};
    std::array<Row, 3> amount{};
    std::vector<int> cones;  // points with one
    // A ball in the frame that holds the points; infinite where light comes from afar.
    Vec<D, float> centre{0.0f};
    float radius = 0;

    // Whether all points lie below the horizon of a receiver.
    bool is_behind(const Receiver& seen) const {
      const Vec<D, float> way = centre - seen.position;
      return way.dot(seen.normal) + radius < -rounding * way.length();
    }
  };
  // Of the points of a block: the greatest code on the way, and the part of a mesh's shadow.
  struct Shadows {
    Row greatest{}, dark{};

    // Whether an isosurface of code `own` is lit from any point.
    bool any_lit(float own) const {
      bool any = false;
      for (int k = 0; k < block; ++k) any |= greatest[k] < own;
      return any;
    }
  };
  struct Maps;
  // The codes of the points of these numbers.
  void find(const VisibilityThroughAll<D>& way, const std::vector<std::size_t>& numbers, bool back,
            Maps& maps, Progress& progress) const;
  // Those of the points that an earlier one has, by their numbers there; -1: it has not.
  void take(const DirectLight& earlier, const std::vector<int>& numbers, bool back, Maps& maps,
            Progress& progress) const;
  // What follows from the codes.
  void summarize(bool back, Maps& maps, Progress& progress) const;
  void fill_blocks();
  // Of points [first, end).
  void bound(Block& of, std::size_t first, std::size_t end) const;
  bool is_dark(const TexelWeights<D>& near, bool back, float own) const;
  Shadows shadows(std::size_t number, const TexelWeights<D>& near, bool back) const;
  // The irradiance at a receiver of code `own` from each point of a block, over the point's amount;
  // without cones.
  static Row arriving(const Block& of, const Receiver& at, const Shadows& shadows, float own);

  IsovalueRange isovalue_range_, code_range_;  // of the field's values
  ColorRamp albedo_, emission_;
  double offset_, scale_;  // isovalue = offset + scale c
  // Shading normals alone then tell what faces a light: the stairs of the values would stay dark
  // (docs/decisions/volumes.md).
  bool has_smooth_normals_;
  Affine<D> to_frame_, to_index_;
  std::vector<LightPoint<D>> points_;
  std::vector<Block> blocks_;
  struct Maps {
    TexelLattice<D> lattice;
    // By side; [slot * points + point].
    std::array<std::vector<std::uint8_t>, 2> codes;
    // The least of a texel's codes: isosurfaces of codes below it lie in the shadow of all points.
    std::array<std::vector<std::uint8_t>, 2> least;
    bool has_dark = false;  // a mesh throws shadows into the volume
  };
  std::shared_ptr<const Maps> maps_;
};

// The resolution of the maps of so many light points for a bake of so many texels along each axis:
// that of the bake where maps then take 24 MB at most; else that of the field or of the bake,
// whichever is coarser, or half of it where maps would take more than 512 MB. `isovalue_range`: of
// the field's values.
template <int D>
Index<D> map_resolution(const Field<D>& field, const IsovalueRange& isovalue_range,
                        const Index<D>& texels, std::size_t points);

// Whether maps of a field may have such a resolution.
template <int D>
bool fits_maps(const Field<D>& field, const Index<D>& resolution);

// What the maps of one side take.
template <int D>
std::size_t map_bytes(const Field<D>& field, const IsovalueRange& isovalue_range,
                      const Index<D>& texels, std::size_t points) {
  const Index<D> resolution = map_resolution(field, isovalue_range, texels, points);
  return active_texels(field, resolution, isovalue_range.min, isovalue_range.max) * (points + 1);
}

}  // namespace leaflight

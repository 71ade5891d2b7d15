// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "base/facet.h"
#include "field/field.h"
#include "lights/light.h"
#include "scene/color_ramp.h"
#include "scene/environment.h"
#include "scene/volume_texture.h"

namespace leaflight {

enum class Scattering { diffuse, mirror, glass };

// A mesh of the walls with the same material on both sides. It exists next to every isosurface: the
// thesis's prism over the range of h (4.3.3).
template <int D>
struct Mesh {
  using Facet = std::array<std::uint32_t, static_cast<std::size_t>(D)>;
  using FacetUv = std::array<Imath::V2f, static_cast<std::size_t>(D)>;

  std::string name;
  std::vector<Vec<D, float>> vertices;  // world
  std::vector<Facet> facets;            // triangles; segments in 2D
  Rgb albedo;                           // in [0,1]; color of a mirror or of glass
  Scattering scattering = Scattering::diffuse;
  double ior = 1.5;                        // of glass, relative to the side of the normals
  Rgb emission{0};                         // radiance [W/(m^2 sr)], from both sides
  std::shared_ptr<const Texture> texture;  // multiplies the albedo; null: none
  std::vector<FacetUv> uv;                 // per corner of each facet, if there is a texture

  // Returns the albedo. u, v: barycentric coordinates of the facet's second and third vertex.
  Rgb albedo_at(std::size_t facet, double u, double v) const;
};

struct IsovalueRange {
  double min = 0;
  double max = 0;

  double height() const { return max - min; }
  bool contains(double c) const { return min <= c && c <= max; }
};

// A field whose isosurfaces are lit. The isosurfaces of all volumes with the same common isovalue c
// see each other. With one volume, c is the isovalue itself.
template <int D>
struct Volume {
  std::string name = "volume";
  Field<D> field;
  ColorRamp albedo;    // over c, in [0,1]; color of a mirror or of glass
  ColorRamp emission;  // over c, radiance [W/(m^2 sr)], from both sides
  Scattering scattering = Scattering::diffuse;
  double ior = 1.5;  // of the inside of glass, relative to the outside
  // isovalue = offset + scale c
  double offset = 0, scale = 1;
  std::shared_ptr<const VolumeTexture<D>> texture;  // multiplies the albedo; null: none

  double isovalue(double c) const { return offset + scale * c; }
  IsovalueRange isovalues(const IsovalueRange& isovalue_range) const {
    return {isovalue(isovalue_range.min), isovalue(isovalue_range.max)};
  }
  double common_isovalue(double h) const { return (h - offset) / scale; }
  // Returns the factor of the texture on the albedo.
  Rgb texture_at(const Vec<D>& index_position) const {
    return texture ? texture->at(index_position) : Rgb(1);
  }
};

// The isosurfaces of volumes within an isovalue range, and the objects around them.
template <int D>
struct Scene {
  std::vector<Volume<D>> volumes;
  std::vector<Mesh<D>> meshes;
  std::vector<Light<D>> lights;
  std::optional<Environment<D>> environment;
  IsovalueRange isovalue_range;  // in common isovalues
};

// True if anything is a mirror or glass.
template <int D>
bool has_specular(const Scene<D>& scene);

// Throws Error with one sentence that names the offending object.
template <int D>
void validate(const Scene<D>& scene);

}  // namespace leaflight

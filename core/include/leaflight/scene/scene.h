// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "leaflight/field/field.h"

namespace leaflight {

// Normal to one edge of the plane, to its left, or to two edges in space, right-handed; as long as
// the segment, or as large as the parallelogram, that the edges span.
inline Vec<2> scaled_normal(const std::array<Vec<2>, 1>& edges) {
  return {-edges[0].y, edges[0].x};
}
inline Vec<3> scaled_normal(const std::array<Vec<3>, 2>& edges) { return edges[0].cross(edges[1]); }

// A mesh of the surroundings, Lambertian on both sides. It stands in every leaf: the thesis's prism
// over the range of h (4.3.3).
template <int D>
struct Mesh {
  using Facet = std::array<std::uint32_t, static_cast<std::size_t>(D)>;

  std::string name;
  std::vector<Vec<D, float>> vertices;  // world
  std::vector<Facet> facets;            // triangles; segments in the plane
  Rgb albedo;                           // in [0,1]
};

// A facet's points as corner + u edge_0 + v edge_1; a segment has no second edge.
template <int D>
struct FacetFrame {
  Vec<D> corner;
  std::array<Vec<D>, static_cast<std::size_t>(D - 1)> edges;

  FacetFrame(const Mesh<D>& mesh, std::size_t facet) {
    const auto& indices = mesh.facets[facet];
    corner = Vec<D>(mesh.vertices[indices[0]]);
    for (int i = 0; i < D - 1; ++i) edges[i] = Vec<D>(mesh.vertices[indices[i + 1]]) - corner;
  }
  Vec<D> point(double u, double v) const {
    if constexpr (D == 2) {
      return corner + edges[0] * u;
    } else {
      return corner + edges[0] * u + edges[1] * v;
    }
  }
  Vec<D> normal() const { return scaled_normal(edges).normalized(); }
  double area() const { return scaled_normal(edges).length() / (D - 1); }
};

// A rectangle, or a segment in the plane, that emits the same radiance [W/(m^2 sr)] from each of
// its points into the half space of its normal. It neither blocks nor reflects light, like
// Blender's area lamp.
template <int D>
struct RectangleLight {
  std::string name;
  Vec<D> corner;                                              // world
  std::array<Vec<D>, static_cast<std::size_t>(D - 1)> edges;  // world
  Rgb radiance;

  // u in [0,1]^2; in the plane the second is not used.
  Vec<D> point(const std::array<double, 2>& u) const {
    Vec<D> p = corner;
    for (int i = 0; i < D - 1; ++i) p += edges[i] * u[i];
    return p;
  }
  double area() const { return scaled_normal(edges).length(); }
  Vec<D> normal() const { return scaled_normal(edges).normalized(); }
};

struct IsovalueWindow {
  double min = 0;
  double max = 0;

  double height() const { return max - min; }
  bool contains(double c) const { return min <= c && c <= max; }
};

// What is lit: the leaves of a field within a window, and what surrounds them.
template <int D>
struct Scene {
  Field<D> field;
  Rgb leaf_albedo;  // in [0,1]
  std::vector<Mesh<D>> meshes;
  std::vector<RectangleLight<D>> lights;
  IsovalueWindow window;
};

// Throws Error with one sentence that names the offending object.
template <int D>
void validate(const Scene<D>& scene);

}  // namespace leaflight

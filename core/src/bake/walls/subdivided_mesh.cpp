// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/walls/subdivided_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "bake/walls/wall_spacing.h"

namespace leaflight {
namespace {

// Light is sampled this share of a piece inside the facet, away from adjacent walls.
constexpr double inset = 0.05;
// Facets that meet at less than 8 degrees belong to one curved surface.
constexpr double cosine_of_one_surface = 0.9903;

template <int D>
using Place = std::array<float, static_cast<std::size_t>(D)>;

template <int D>
Place<D> place_of(const Vec<D>& position) {
  Place<D> place;
  for (int a = 0; a < D; ++a) place[a] = static_cast<float>(position[a]);
  return place;
}

template <int D>
bool on_one_surface(const Vec<D>& a, const Vec<D>& b) {
  return a.dot(b) > cosine_of_one_surface;
}

// The normals at the corners of a mesh's facets, averaged over the facets of one surface.
template <int D>
class CornerNormals {
 public:
  explicit CornerNormals(const Mesh<D>& mesh) : mesh_(mesh) {
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
      facets_.push_back(FacetFrame<D>(mesh, f).normal());
      for (const std::uint32_t v : mesh.facets[f]) at_[place(v)].push_back(f);
    }
  }

  std::array<Vec<D>, static_cast<std::size_t>(D)> at_corners(int facet) const {
    std::array<Vec<D>, static_cast<std::size_t>(D)> normals;
    for (int k = 0; k < D; ++k) {
      normals[k] = Vec<D>(0.0);
      for (const std::size_t f : at_.at(place(mesh_.facets[facet][k]))) {
        if (on_one_surface<D>(facets_[f], facets_[facet])) normals[k] += facets_[f];
      }
      normals[k].normalize();
    }
    return normals;
  }

 private:
  Place<D> place(std::uint32_t vertex) const { return place_of<D>(Vec<D>(mesh_.vertices[vertex])); }

  const Mesh<D>& mesh_;
  std::vector<Vec<D>> facets_;
  std::map<Place<D>, std::vector<std::size_t>> at_;
};

// A corner of a piece of a facet. Its coordinates in the facet are exact, because they are sums of
// a few powers of 1/2.
struct Corner {
  double u, v;
  std::uint32_t vertex;
};

template <int D>
struct Piece {
  int facet;
  std::array<Corner, static_cast<std::size_t>(D)> corners;
};

// A mesh in pieces with numbered vertices.
template <int D>
struct CutMesh {
  struct Vertex {
    int facet;
    double u, v;
    std::array<std::uint32_t, 2> ends;  // of the split edge; twice the same for a mesh's own vertex
  };
  std::vector<Vertex> vertices;
  std::vector<Piece<D>> pieces;
};

// Interpolates values at the corners of a facet. Both facets of an edge give the same bits.
template <int D>
Vec<D> between(const std::array<Vec<D>, static_cast<std::size_t>(D)>& corners, double u, double v) {
  Vec<D> sum = corners[0] * (1 - u - v) + corners[1] * u;
  if constexpr (D == 3) sum += corners[2] * v;
  return sum;
}

template <int D>
std::array<Vec<D>, static_cast<std::size_t>(D)> corners_of(const Mesh<D>& mesh, int facet) {
  std::array<Vec<D>, static_cast<std::size_t>(D)> corners;
  for (int k = 0; k < D; ++k) corners[k] = Vec<D>(mesh.vertices[mesh.facets[facet][k]]);
  return corners;
}

// Splits the pieces of one mesh. Edges are split by their ends alone, so that pieces on both sides
// match.
template <int D>
class MeshCutter {
 public:
  explicit MeshCutter(const Mesh<D>& mesh) : mesh_(mesh), normals_(mesh) {
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
      enter(static_cast<int>(f));
      Piece<D> piece{facet_, {original(0, 0), original(1, 0)}};
      if constexpr (D == 3) piece.corners[2] = original(0, 1);
      cut_.pieces.push_back(piece);
    }
  }

  // Splits pieces until no edge is longer than the spacing at its middle.
  void cut(const WallSpacing<D>& spacing) {
    const auto is_long = [&](const Vec<D>& a, const Vec<D>& b) {
      return (b - a).length() > spacing.at((a + b) * 0.5);
    };
    std::vector<Piece<D>> open = std::move(cut_.pieces), done;
    while (!open.empty()) {
      const Piece<D> piece = open.back();
      open.pop_back();
      if (!split(piece, is_long, open)) done.push_back(piece);
    }
    cut_.pieces = std::move(done);
  }

  // Splits each edge in two. The old vertices keep their numbers.
  void halve() {
    std::vector<Piece<D>> pieces;
    for (const Piece<D>& piece : cut_.pieces) {
      split(
          piece, [](const Vec<D>&, const Vec<D>&) { return true; }, pieces);
    }
    cut_.pieces = std::move(pieces);
  }

  const CutMesh<D>& result() const { return cut_; }

 private:
  void enter(int facet) {
    if (facet == facet_) return;
    facet_ = facet;
    positions_ = corners_of(mesh_, facet);
    corner_normals_ = normals_.at_corners(facet);
  }
  Vec<D> position(const Corner& corner) const { return between<D>(positions_, corner.u, corner.v); }

  Corner original(double u, double v) {
    const auto next = static_cast<std::uint32_t>(cut_.vertices.size());
    return corner(u, v, {next, next});
  }

  // Returns a corner. Vertices at the same position with similar normals are merged.
  Corner corner(double u, double v, const std::array<std::uint32_t, 2>& ends) {
    const Vec<D> normal = between<D>(corner_normals_, u, v).normalized();
    auto& here = at_[place_of<D>(between<D>(positions_, u, v))];
    for (const auto& [vertex, its_normal] : here) {
      if (on_one_surface<D>(its_normal, normal)) return {u, v, vertex};
    }
    const auto number = static_cast<std::uint32_t>(cut_.vertices.size());
    here.emplace_back(number, normal);
    cut_.vertices.push_back({facet_, u, v, ends});
    return {u, v, number};
  }

  Corner middle(const Corner& a, const Corner& b) {
    return corner((a.u + b.u) / 2, (a.v + b.v) / 2, {a.vertex, b.vertex});
  }

  // Adds the parts of a piece to `parts`; adds none and returns false if no edge is split.
  template <class IsCut>
  bool split(const Piece<D>& piece, const IsCut& is_cut, std::vector<Piece<D>>& parts) {
    enter(piece.facet);
    const auto& corners = piece.corners;
    std::array<bool, 3> cut{};
    for (int k = 0; k < (D == 2 ? 1 : 3); ++k) {
      cut[k] = is_cut(position(corners[k]), position(corners[(k + 1) % D]));
    }
    const int count = cut[0] + cut[1] + cut[2];
    if (count == 0) return false;
    if constexpr (D == 2) {
      const Corner half = middle(corners[0], corners[1]);
      parts.push_back({facet_, {corners[0], half}});
      parts.push_back({facet_, {half, corners[1]}});
    } else {
      // Start at a split edge whose predecessor is not split.
      int first = 0;
      while (count < 3 && !(cut[first] && !cut[(first + 2) % 3])) ++first;
      split_triangle(corners[first], corners[(first + 1) % 3], corners[(first + 2) % 3], count,
                     parts);
    }
    return true;
  }

  // Splits a triangle at its first `edges` edges.
  void split_triangle(const Corner& a, const Corner& b, const Corner& c, int edges,
                      std::vector<Piece<D>>& parts) {
    const auto add = [&](const Corner& p, const Corner& q, const Corner& r) {
      parts.push_back({facet_, {p, q, r}});
    };
    const Corner ab = middle(a, b);
    if (edges == 1) {
      add(a, ab, c);
      add(ab, b, c);
      return;
    }
    const Corner bc = middle(b, c);
    add(ab, b, bc);
    if (edges == 3) {
      const Corner ca = middle(c, a);
      add(a, ab, ca);
      add(ca, bc, c);
      add(ab, bc, ca);
    } else if ((position(bc) - position(a)).length() < (position(c) - position(ab)).length()) {
      add(a, ab, bc);
      add(a, bc, c);
    } else {
      add(a, ab, c);
      add(ab, bc, c);
    }
  }

  const Mesh<D>& mesh_;
  CornerNormals<D> normals_;
  CutMesh<D> cut_;
  std::map<Place<D>, std::vector<std::pair<std::uint32_t, Vec<D>>>> at_;
  int facet_ = -1;  // current facet and its corners
  std::array<Vec<D>, static_cast<std::size_t>(D)> positions_, corner_normals_;
};

// Returns the widest extent of the smallest piece at each vertex, in coordinates of its facet.
template <int D>
std::vector<double> extents(const CutMesh<D>& cut) {
  std::vector<double> extents(cut.vertices.size(), 1);
  for (const Piece<D>& piece : cut.pieces) {
    double extent = 0;
    for (int k = 0; k < D; ++k) {
      const Corner &a = piece.corners[k], &b = piece.corners[(k + 1) % D];
      extent = std::max({extent, std::abs(b.u - a.u), std::abs(b.v - a.v)});
    }
    for (const Corner& corner : piece.corners) {
      extents[corner.vertex] = std::min(extents[corner.vertex], extent);
    }
  }
  return extents;
}

// Puts the pieces on a mesh with the same facets as the one that was split.
template <int D>
FineMesh<D> fine_mesh(const CutMesh<D>& cut, const Mesh<D>& mesh, const CornerNormals<D>& normals,
                      int number) {
  const std::vector<double> extent = extents(cut);
  FineMesh<D> fine;
  for (std::size_t i = 0; i < cut.vertices.size(); ++i) {
    const auto& [facet, u, v, ends] = cut.vertices[i];
    fine.vertices.emplace_back(between<D>(corners_of(mesh, facet), u, v));
    fine.normals.push_back(between<D>(normals.at_corners(facet), u, v).normalized());
    // Pull towards the middle of the facet; interior vertices hardly move.
    const double pull = std::min(1.0, inset * D * extent[i]);
    fine.places.push_back(
        {number, facet, u + (1.0 / D - u) * pull, D == 2 ? 0 : v + (1.0 / D - v) * pull, true});
  }
  for (const Piece<D>& piece : cut.pieces) {
    typename Mesh<D>::Facet& facet = fine.facets.emplace_back();
    for (int k = 0; k < D; ++k) facet[k] = piece.corners[k].vertex;
  }
  return fine;
}

}  // namespace
template <int D>
std::vector<SubdividedMesh<D>> subdivide(const Scene<D>& scene) {
  std::vector<int> itself(scene.meshes.size());
  std::iota(itself.begin(), itself.end(), 0);
  return subdivide_as(scene, scene, itself);
}

template <int D>
std::vector<SubdividedMesh<D>> subdivide_as(const Scene<D>& earlier, const Scene<D>& scene,
                                            const std::vector<int>& same_as) {
  const WallSpacing<D> then(earlier), now(scene);
  std::vector<SubdividedMesh<D>> subdivided(scene.meshes.size());
  for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
    const Mesh<D>& mesh = scene.meshes[m];
    const CornerNormals<D> normals(mesh);
    const int number = static_cast<int>(m);
    const bool is_new = same_as[m] < 0;
    MeshCutter<D> cutter(is_new ? mesh : earlier.meshes[same_as[m]]);
    cutter.cut(is_new ? now : then);
    SubdividedMesh<D>& result = subdivided[m];
    result.coarse = fine_mesh(cutter.result(), mesh, normals, number);
    cutter.halve();
    result.fine = fine_mesh(cutter.result(), mesh, normals, number);
    for (const auto& vertex : cutter.result().vertices) {
      const auto v = static_cast<std::uint32_t>(result.between.size());
      const bool is_coarse = v < result.coarse.vertices.size();
      result.between.push_back(is_coarse ? std::array<std::uint32_t, 2>{v, v} : vertex.ends);
    }
  }
  return subdivided;
}

template <int D>
SurfacePoint<D> vertex_point(const SceneTracer<D>& tracer, const FineMesh<D>& mesh,
                             std::size_t vertex, bool front, double c) {
  const FacetPoint& p = mesh.places[vertex];
  SurfacePoint<D> point = tracer.facet_point(p.mesh, p.facet, p.u, p.v, front, c);
  point.geometric_normal = front ? mesh.normals[vertex] : -mesh.normals[vertex];
  point.shading_normal = point.geometric_normal;
  return point;
}

template std::vector<SubdividedMesh<2>> subdivide<2>(const Scene<2>&);
template std::vector<SubdividedMesh<3>> subdivide<3>(const Scene<3>&);
template std::vector<SubdividedMesh<2>> subdivide_as<2>(const Scene<2>&, const Scene<2>&,
                                                        const std::vector<int>&);
template std::vector<SubdividedMesh<3>> subdivide_as<3>(const Scene<3>&, const Scene<3>&,
                                                        const std::vector<int>&);
template SurfacePoint<2> vertex_point<2>(const SceneTracer<2>&, const FineMesh<2>&, std::size_t,
                                         bool, double);
template SurfacePoint<3> vertex_point<3>(const SceneTracer<3>&, const FineMesh<3>&, std::size_t,
                                         bool, double);

}  // namespace leaflight

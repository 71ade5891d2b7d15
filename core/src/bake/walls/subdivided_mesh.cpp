// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/walls/subdivided_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace leaflight {
namespace {

// Coarse pieces that all walls together are cut into, about.
template <int D>
constexpr double target_pieces = D == 3 ? 16384 : 1024;
constexpr int most_cuts = 128;
// Vertices are lit this share of a piece within the facet, where no other wall touches it.
constexpr double inset = 0.05;
// Facets that meet at less than 8 degrees are of one curved surface.
constexpr double cosine_of_one_surface = 0.9903;
// Facets this far from the middle of the volumes, in longest sides of their box, and nearer ones
// are cut most finely.
constexpr double close_by = 0.6;

template <int D>
using Place = std::array<float, static_cast<std::size_t>(D)>;

template <int D>
Place<D> place_of(const Vec<D>& position) {
  Place<D> place;
  for (int a = 0; a < D; ++a) place[a] = static_cast<float>(position[a]);
  return place;
}

template <int D>
bool of_one_surface(const Vec<D>& a, const Vec<D>& b) {
  return a.dot(b) > cosine_of_one_surface;
}

// The normals at the corners of a mesh's facets: the mean over the facets of one surface there.
template <int D>
class CornerNormals {
 public:
  explicit CornerNormals(const Mesh<D>& mesh) : mesh_(mesh) {
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
      facets_.push_back(FacetFrame<D>(mesh, f).normal());
      for (const std::uint32_t v : mesh.facets[f]) at_[place(v)].push_back(f);
    }
  }

  std::array<Vec<D>, static_cast<std::size_t>(D)> of(int facet) const {
    std::array<Vec<D>, static_cast<std::size_t>(D)> normals;
    for (int k = 0; k < D; ++k) {
      normals[k] = Vec<D>(0.0);
      for (const std::size_t f : at_.at(place(mesh_.facets[facet][k]))) {
        if (of_one_surface<D>(facets_[f], facets_[facet])) normals[k] += facets_[f];
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

// Vertices of one mesh that have the same place and look into nearly the same direction are one.
template <int D>
class Welder {
 public:
  explicit Welder(FineMesh<D>& mesh) : mesh_(mesh) {}

  std::uint32_t vertex(const Vec<D>& position, const Vec<D>& normal, const FacetPoint& place,
                       const std::array<int, 2>& number) {
    std::vector<std::uint32_t>& here = at_[place_of<D>(position)];
    for (const std::uint32_t v : here) {
      if (of_one_surface<D>(mesh_.normals[v], normal)) return v;
    }
    here.push_back(static_cast<std::uint32_t>(mesh_.vertices.size()));
    mesh_.vertices.emplace_back(position);
    mesh_.places.push_back(place);
    mesh_.normals.push_back(normal);
    mesh_.numbers.push_back(number);
    return here.back();
  }
  void facet(const typename Mesh<D>::Facet& facet) { mesh_.facets.push_back(facet); }

 private:
  FineMesh<D>& mesh_;
  std::map<Place<D>, std::vector<std::uint32_t>> at_;
};

// Cuts one facet of a mesh; its vertices have the numbers 0 to `cuts` along each edge.
template <int D>
class FacetCutter {
 public:
  FacetCutter(const Mesh<D>& mesh, const CornerNormals<D>& normals, int number, int facet, int cuts,
              Welder<D>& welder)
      : mesh_of_(mesh),
        normals_(normals.of(facet)),
        mesh_(number),
        facet_(facet),
        cuts_(cuts),
        welder_(welder) {}

  std::uint32_t vertex(int i, int j) {
    const double u = static_cast<double>(i) / cuts_, v = static_cast<double>(j) / cuts_;
    FacetPoint place{mesh_, facet_, u, v, true};
    if constexpr (D == 2) {
      const double margin = inset / cuts_;
      place.u = std::clamp(u, margin, 1 - margin);
    } else {
      // Towards the middle of the facet; an interior vertex stays all but where it is.
      const double pull = inset * 3 / cuts_;
      place.u += (1.0 / 3 - u) * pull;
      place.v += (1.0 / 3 - v) * pull;
    }
    std::array<Vec<D>, static_cast<std::size_t>(D)> corners;
    for (int k = 0; k < D; ++k) corners[k] = Vec<D>(mesh_of_.vertices[mesh_of_.facets[facet_][k]]);
    return welder_.vertex(between(corners, {i, j}), between(normals_, {i, j}).normalized(), place,
                          {i, j});
  }

  void cut() {
    for (int j = 0; j < (D == 2 ? 1 : cuts_); ++j) {
      for (int i = 0; i < cuts_ - j; ++i) {
        if constexpr (D == 2) {
          welder_.facet({vertex(i, 0), vertex(i + 1, 0)});
        } else {
          welder_.facet({vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)});
          if (i + 1 < cuts_ - j) {
            welder_.facet({vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
          }
        }
      }
    }
  }

 private:
  // Alike for both facets of an edge, to the last bit.
  Vec<D> between(const std::array<Vec<D>, static_cast<std::size_t>(D)>& corners,
                 const std::array<int, 2>& number) const {
    Vec<D> sum = corners[0] * (cuts_ - number[0] - number[1]);
    for (int k = 1; k < D; ++k) sum += corners[k] * number[k - 1];
    return sum / cuts_;
  }

  const Mesh<D>& mesh_of_;
  std::array<Vec<D>, static_cast<std::size_t>(D)> normals_;
  int mesh_, facet_, cuts_;
  Welder<D>& welder_;
};

// Both meshes of one facet, and what lies between which vertices.
template <int D>
void cut_twice(const Mesh<D>& mesh, const CornerNormals<D>& normals, int number, int facet,
               int cuts, Welder<D>& coarse_welder, Welder<D>& fine_welder,
               SubdividedMesh<D>& subdivided) {
  FacetCutter<D> coarse(mesh, normals, number, facet, cuts, coarse_welder);
  FacetCutter<D> fine(mesh, normals, number, facet, 2 * cuts, fine_welder);
  coarse.cut();
  fine.cut();
  subdivided.between.resize(subdivided.fine.vertices.size());
  for (int j = 0; j <= (D == 2 ? 0 : 2 * cuts); ++j) {
    for (int i = 0; i <= 2 * cuts - j; ++i) {
      // In the middle of a diagonal edge both are odd.
      subdivided.between[fine.vertex(i, j)] = {coarse.vertex(i / 2, (j + 1) / 2),
                                               coarse.vertex((i + 1) / 2, j / 2)};
    }
  }
}

// How finely a facet is to be cut, against its area: by its distance from the middle of the
// volumes.
template <int D>
double fineness(const Mesh<D>& mesh, std::size_t facet, const Frame<D>& frame) {
  Box<D> box;
  for (const std::uint32_t v : mesh.facets[facet])
    box.extend(frame.point(Vec<D>(mesh.vertices[v])));
  Vec<D> nearest;
  for (int a = 0; a < D; ++a) nearest[a] = std::clamp(0.0, box.low[a], box.high[a]);
  return std::pow(close_by / std::max(close_by, nearest.length()), 3);
}

// Along how many pieces the edges of a scene's facets are cut.
template <int D>
class Cuts {
 public:
  explicit Cuts(const Scene<D>& scene) : scene_(scene), frame_(scene) {
    for (const Mesh<D>& mesh : scene.meshes) {
      for (std::size_t f = 0; f < mesh.facets.size(); ++f) total_ += weight(mesh, f);
    }
  }

  int of(std::size_t mesh, std::size_t facet) const {
    const double share = total_ > 0 ? weight(scene_.meshes[mesh], facet) / total_ : 0;
    const double cuts = std::pow(share * target_pieces<D>, 1.0 / (D - 1));
    return std::clamp(static_cast<int>(std::lround(cuts)), 1, most_cuts);
  }

 private:
  double weight(const Mesh<D>& mesh, std::size_t facet) const {
    return FacetFrame<D>(mesh, facet).area() * fineness(mesh, facet, frame_);
  }

  const Scene<D>& scene_;
  Frame<D> frame_;
  double total_ = 0;
};

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
  const std::vector<Mesh<D>>& meshes = scene.meshes;
  const Cuts<D> then(earlier), now(scene);
  std::vector<SubdividedMesh<D>> subdivided(meshes.size());
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const CornerNormals<D> normals(meshes[m]);
    Welder<D> coarse(subdivided[m].coarse), fine(subdivided[m].fine);
    for (std::size_t f = 0; f < meshes[m].facets.size(); ++f) {
      const int cuts = same_as[m] < 0 ? now.of(m, f) : then.of(same_as[m], f);
      cut_twice(meshes[m], normals, static_cast<int>(m), static_cast<int>(f), cuts, coarse, fine,
                subdivided[m]);
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

// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/refined_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace leaflight {
namespace {

// Coarse pieces that all surroundings together are cut into, about.
template <int D>
constexpr double target_pieces = D == 3 ? 16384 : 1024;
constexpr int most_cuts = 128;
// Vertices are lit this share of a piece within the facet, where no other wall touches it.
constexpr double inset = 0.05;

// Vertices of one mesh that have the same place and look into the same direction are one.
template <int D>
class Welder {
 public:
  explicit Welder(FineMesh<D>& mesh) : mesh_(mesh) {}

  std::uint32_t vertex(const Vec<D>& position, const Vec<D>& normal, const FacetPoint& place,
                       const std::array<int, 2>& number) {
    Key key;
    for (int a = 0; a < D; ++a) {
      key[a] = static_cast<float>(position[a]);
      key[D + a] = static_cast<float>(std::lround(normal[a] * 64));
    }
    const auto [found, added] =
        numbers_.emplace(key, static_cast<std::uint32_t>(mesh_.vertices.size()));
    if (added) {
      mesh_.vertices.emplace_back(position);
      mesh_.places.push_back(place);
      mesh_.numbers.push_back(number);
    }
    return found->second;
  }
  void facet(const typename Mesh<D>::Facet& facet) { mesh_.facets.push_back(facet); }

 private:
  using Key = std::array<float, static_cast<std::size_t>(2 * D)>;
  FineMesh<D>& mesh_;
  std::map<Key, std::uint32_t> numbers_;
};

// Cuts one facet of a mesh; its vertices have the numbers 0 to `cuts` along each edge.
template <int D>
class FacetCutter {
 public:
  FacetCutter(const Mesh<D>& mesh, int number, int facet, int cuts, Welder<D>& welder)
      : frame_(mesh, facet),
        normal_(frame_.normal()),
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
    return welder_.vertex(frame_.point(u, v), normal_, place, {i, j});
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
  FacetFrame<D> frame_;
  Vec<D> normal_;
  int mesh_, facet_, cuts_;
  Welder<D>& welder_;
};

// Both meshes of one facet, and what lies between which vertices.
template <int D>
void cut_twice(const Mesh<D>& mesh, int number, int facet, int cuts, Welder<D>& coarse_welder,
               Welder<D>& fine_welder, RefinedMesh<D>& refined) {
  FacetCutter<D> coarse(mesh, number, facet, cuts, coarse_welder);
  FacetCutter<D> fine(mesh, number, facet, 2 * cuts, fine_welder);
  coarse.cut();
  fine.cut();
  refined.between.resize(refined.fine.vertices.size());
  for (int j = 0; j <= (D == 2 ? 0 : 2 * cuts); ++j) {
    for (int i = 0; i <= 2 * cuts - j; ++i) {
      // In the middle of a diagonal edge both are odd.
      refined.between[fine.vertex(i, j)] = {coarse.vertex(i / 2, (j + 1) / 2),
                                            coarse.vertex((i + 1) / 2, j / 2)};
    }
  }
}

}  // namespace

template <int D>
std::vector<RefinedMesh<D>> refine(const std::vector<Mesh<D>>& meshes) {
  double total = 0;
  for (const Mesh<D>& mesh : meshes) {
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) total += FacetFrame<D>(mesh, f).area();
  }
  std::vector<RefinedMesh<D>> refined(meshes.size());
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    Welder<D> coarse(refined[m].coarse), fine(refined[m].fine);
    for (std::size_t f = 0; f < meshes[m].facets.size(); ++f) {
      const double share = total > 0 ? FacetFrame<D>(meshes[m], f).area() / total : 0;
      const double cuts = std::pow(share * target_pieces<D>, 1.0 / (D - 1));
      cut_twice(meshes[m], static_cast<int>(m), static_cast<int>(f),
                std::clamp(static_cast<int>(std::lround(cuts)), 1, most_cuts), coarse, fine,
                refined[m]);
    }
  }
  return refined;
}

template std::vector<RefinedMesh<2>> refine<2>(const std::vector<Mesh<2>>&);
template std::vector<RefinedMesh<3>> refine<3>(const std::vector<Mesh<3>>&);

}  // namespace leaflight

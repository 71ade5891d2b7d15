// SPDX-License-Identifier: GPL-3.0-or-later
#include "bake/walls/wall_spacing.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "trace/scene_tracer.h"

namespace leaflight {
namespace {

// Distance at which the spacing is twice that at a volume, in longest sides of the volumes' box.
constexpr double doubled_at = 0.2;
template <int D>
constexpr double slope = D == 3 ? 0.11 : 0.01;
// Target number of pieces of all walls; the spacing grows if there are more.
template <int D>
constexpr double most_pieces = D == 3 ? 40000 : 8192;
// Pieces per unit of area for a spacing of 1; edges are between half the spacing and all of it.
template <int D>
constexpr double pieces_per_area = D == 3 ? 4 : 1.4;
constexpr int most_strips = 16;

}  // namespace

template <int D>
WallSpacing<D>::WallSpacing(const Scene<D>& scene)
    : closest_(doubled_at / Frame<D>(scene).scale), slope_(slope<D>) {
  for (const Volume<D>& volume : scene.volumes) volumes_.push_back(world_box(volume.field));
  const double many = expected_pieces(scene) / most_pieces<D>;
  if (many > 1) slope_ *= std::pow(many, 1.0 / (D - 1));
}

template <int D>
double WallSpacing<D>::distance(const Vec<D>& place) const {
  double nearest = volumes_.empty() ? 0 : std::numeric_limits<double>::infinity();
  for (const Box<D>& box : volumes_) {
    Vec<D> inside = place;
    for (int a = 0; a < D; ++a) inside[a] = std::clamp(place[a], box.low[a], box.high[a]);
    nearest = std::min(nearest, (place - inside).length());
  }
  return nearest;
}

template <int D>
double WallSpacing<D>::expected_pieces(const Scene<D>& scene) const {
  double pieces = 0;
  for (const Mesh<D>& mesh : scene.meshes) {
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
      const FacetFrame<D> facet(mesh, f);
      double longest = 0;
      for (const Vec<D>& edge : facet.edges) longest = std::max(longest, edge.length());
      const int strips =
          std::clamp(static_cast<int>(std::min(longest / closest_, 1e3)), 1, most_strips);
      double density = 0;
      int count = 0;
      for (int j = 0; j < (D == 2 ? 1 : strips); ++j) {
        for (int i = 0; i < strips - j; ++i, ++count) {
          const double u = (i + 1.0 / D) / strips, v = (j + 1.0 / D) / strips;
          density += std::pow(at(facet.point(u, v)), 1 - D);
        }
      }
      pieces += std::max(1.0, pieces_per_area<D> * facet.area() * density / count);
    }
  }
  return pieces;
}

template class WallSpacing<2>;
template class WallSpacing<3>;

}  // namespace leaflight

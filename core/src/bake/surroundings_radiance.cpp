// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/bake/surroundings_radiance.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "leaflight/math/error.h"

namespace leaflight {
namespace {

// Pieces that all surroundings together are cut into, about.
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

  std::uint32_t vertex(const Vec<D>& position, const Vec<D>& normal, const FacetPoint& place) {
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
    }
    return found->second;
  }

 private:
  using Key = std::array<float, static_cast<std::size_t>(2 * D)>;
  FineMesh<D>& mesh_;
  std::map<Key, std::uint32_t> numbers_;
};

void cut(const Mesh<2>& mesh, int m, int facet, int cuts, FineMesh<2>& fine, Welder<2>& welder) {
  const FacetFrame<2> frame(mesh, facet);
  std::uint32_t before = 0;
  for (int i = 0; i <= cuts; ++i) {
    const double u = static_cast<double>(i) / cuts, margin = inset / cuts;
    const std::uint32_t vertex = welder.vertex(
        frame.point(u, 0), frame.normal(), {m, facet, std::clamp(u, margin, 1 - margin), 0, true});
    if (i > 0) fine.facets.push_back({before, vertex});
    before = vertex;
  }
}

void cut(const Mesh<3>& mesh, int m, int facet, int cuts, FineMesh<3>& fine, Welder<3>& welder) {
  const FacetFrame<3> frame(mesh, facet);
  const Vec3 normal = frame.normal();
  const auto vertex = [&](int i, int j) {
    const double u = static_cast<double>(i) / cuts, v = static_cast<double>(j) / cuts;
    // Towards the middle of the facet; an interior vertex stays all but where it is.
    const double pull = inset * 3 / cuts;
    const double inner_u = u + (1.0 / 3 - u) * pull, inner_v = v + (1.0 / 3 - v) * pull;
    return welder.vertex(frame.point(u, v), normal, {m, facet, inner_u, inner_v, true});
  };
  for (int j = 0; j < cuts; ++j) {
    for (int i = 0; i < cuts - j; ++i) {
      fine.facets.push_back({vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)});
      if (i + 1 < cuts - j) {
        fine.facets.push_back({vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
      }
    }
  }
}

}  // namespace

template <int D>
std::vector<FineMesh<D>> refine(const std::vector<Mesh<D>>& meshes) {
  double total = 0;
  for (const Mesh<D>& mesh : meshes) {
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) total += FacetFrame<D>(mesh, f).area();
  }
  std::vector<FineMesh<D>> fine(meshes.size());
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    Welder<D> welder(fine[m]);
    for (std::size_t f = 0; f < meshes[m].facets.size(); ++f) {
      const double share = total > 0 ? FacetFrame<D>(meshes[m], f).area() / total : 0;
      const double cuts = std::pow(share * target_pieces<D>, 1.0 / (D - 1));
      cut(meshes[m], static_cast<int>(m), static_cast<int>(f),
          std::clamp(static_cast<int>(std::lround(cuts)), 1, most_cuts), fine[m], welder);
    }
  }
  return fine;
}

template <int D>
std::vector<Vec<3, float>> radiance_at(const SurroundingsRadiance<D>& surroundings, int mesh,
                                       double c, bool back) {
  const std::size_t n = surroundings.meshes[mesh].vertices.size();
  const auto& values = surroundings.radiance[mesh][back];
  std::vector<Vec<3, float>> radiance(n, Vec<3, float>(0));
  if (values.empty()) return radiance;
  const LeafNodes::Place at = surroundings.nodes.place(c);
  const auto t = static_cast<float>(at.t);
  for (std::size_t i = 0; i < n; ++i) {
    radiance[i] = values[at.low * n + i] * (1 - t) + values[(at.low + 1) * n + i] * t;
  }
  return radiance;
}

template <int D>
void attach(SurroundingsRadiance<D>& radiance, const Scene<D>& scene) {
  radiance.meshes = refine(scene.meshes);
  radiance.nodes = LeafNodes(scene);
  bool fits = radiance.meshes.size() == radiance.radiance.size();
  for (std::size_t m = 0; fits && m < scene.meshes.size(); ++m) {
    const std::size_t entries = radiance.meshes[m].vertices.size() * LeafNodes::count;
    for (const auto& side : radiance.radiance[m]) {
      fits = fits && (side.empty() || side.size() == entries);
    }
  }
  if (!fits) {
    throw Error(
        "The radiance of the surroundings does not belong to the meshes of its scene; bake again.");
  }
}

template void attach<2>(SurroundingsRadiance<2>&, const Scene<2>&);
template void attach<3>(SurroundingsRadiance<3>&, const Scene<3>&);
template std::vector<FineMesh<2>> refine<2>(const std::vector<Mesh<2>>&);
template std::vector<FineMesh<3>> refine<3>(const std::vector<Mesh<3>>&);
template std::vector<Vec<3, float>> radiance_at<2>(const SurroundingsRadiance<2>&, int, double,
                                                   bool);
template std::vector<Vec<3, float>> radiance_at<3>(const SurroundingsRadiance<3>&, int, double,
                                                   bool);

}  // namespace leaflight

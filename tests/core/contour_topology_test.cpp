// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the topology of contours: against densely sampled cells, and as manifolds.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <cstring>

#include "fields.h"
#include "meshes.h"
#include "surface/cell_polygons.h"
#include "surface/cell_tunnels.h"
#include "surface/marching_cubes.h"

namespace leaflight {
namespace {

using Corners = std::array<double, 8>;

// Bounds on the number of regions that the samples on one side of the isosurface form, in the cell
// or on its faces. `least` connects samples that touch at a corner; `most` connects only neighbors
// along an axis.
struct Regions {
  int least = 0, most = 0;
};

class SampledCell {
 public:
  SampledCell(const Corners& g, int n) : n_(n), above_(n * n * n) {
    for (int i = 0; i < n * n * n; ++i) {
      const Index<3> at = index_of<3>(i, {n, n, n});
      above_[i] = interpolate(CellCorners<3>{g}, to_vector<3>(at) / (n - 1.0)) >= 0;
    }
  }

  Regions regions(bool above, bool faces) const {
    return {count(above, faces, 3), count(above, faces, 1)};
  }

 private:
  int count(bool above, bool faces, int most_steps) const {
    std::vector<bool> seen(above_.size(), false);
    std::vector<int> open;
    int found = 0;
    const auto take = [&](const Index<3>& at) {
      const auto i = static_cast<int>(linear_number<3>(at, {n_, n_, n_}));
      bool on_face = false;
      for (const int x : at) on_face = on_face || x == 0 || x == n_ - 1;
      if (seen[i] || above_[i] != above || (faces && !on_face)) return false;
      seen[i] = true;
      open.push_back(i);
      return true;
    };
    for (int start = 0; start < static_cast<int>(above_.size()); ++start) {
      if (!take(index_of<3>(start, {n_, n_, n_}))) continue;
      ++found;
      while (!open.empty()) {
        const Index<3> at = index_of<3>(open.back(), {n_, n_, n_});
        open.pop_back();
        Index<3> low, high;
        for (int a = 0; a < 3; ++a) {
          low[a] = std::max(0, at[a] - 1);
          high[a] = std::min(n_, at[a] + 2);
        }
        for_each_index<3>(low, high, [&](const Index<3>& other) {
          int steps = 0;
          for (int a = 0; a < 3; ++a) steps += std::abs(other[a] - at[a]);
          if (steps > 0 && steps <= most_steps) take(other);
        });
      }
    }
    return found;
  }

  int n_;
  std::vector<bool> above_;
};

// The number of surfaces in a cell, and of closed lines on its faces. n regions of
// a ball, or of a sphere, have n - 1 boundaries.
struct Topology {
  int surfaces, borders;
};

// Computes the topology of a cell from samples; negative if they are ambiguous.
Topology sampled_topology(const Corners& g) {
  for (const int n : {12, 24, 40}) {
    const SampledCell cell(g, n);
    std::array<int, 2> regions{0, 0};
    bool sure = true;
    for (const bool faces : {false, true}) {
      for (const bool above : {false, true}) {
        const Regions found = cell.regions(above, faces);
        sure = sure && found.least == found.most;
        regions[faces] += found.least;
      }
    }
    if (sure) return {regions[0] - 1, regions[1] - 1};
  }
  return {-1, -1};
}

Corners random_corners(Random& random, int kind) {
  Corners g;
  for (int i = 0; i < 8; ++i) {
    const double size = kind < 2 ? random.uniform() : std::exp(4 * random.uniform());
    // Kind 2: the corners alternate on every face.
    const bool above = kind == 2 ? __builtin_parity(i) != 0 : random.uniform() < 0.5;
    g[i] = (above ? 1 : -1) * size;
  }
  return g;
}

// Returns the lines in which the isosurface intersects the faces of the cell.
std::vector<std::vector<int>> polygons_of(const Corners& g) {
  unsigned above = 0;
  for (int corner = 0; corner < 8; ++corner) above |= (g[corner] >= 0) << corner;
  return cell_polygons(above, joined_faces(g, above));
}

IsosurfaceMesh mesh_of(const Corners& g) {
  return contour(test::field_from<3>({g.begin(), g.end()}, {2, 2, 2}, test::unit_cube<3>(2)), 0.0);
}

TEST(ContourTopology, OfRandomCellsIsThatOfTheTrilinearInterpolant) {
  Random random(7);
  int drawn = 0, decided = 0, tunnels = 0;
  constexpr int cells = 2000;
  for (int i = 0; drawn < cells; ++i) {
    Corners g = random_corners(random, i % 3);
    for (double& h : g) h = static_cast<float>(h);
    // Test mostly cells in which a tunnel is possible.
    const bool undecided = polygons_of(g).size() > 1 && cell_saddles(g).count > 0;
    if (!undecided && i % 20 != 0) continue;
    ++drawn;
    const Topology truth = sampled_topology(g);
    if (truth.surfaces < 0) continue;
    ++decided;
    if (truth.surfaces == 0) continue;
    const IsosurfaceMesh mesh = mesh_of(g);
    const test::Parts found = test::parts_of(mesh);
    ASSERT_EQ(found.surfaces, truth.surfaces) << "cell " << i;
    ASSERT_EQ(found.borders, truth.borders) << "cell " << i;
    // The mesh has no other handles or holes.
    ASSERT_EQ(test::euler_characteristic(mesh), 2 * truth.surfaces - truth.borders) << "cell " << i;
    test::expect_manifold(mesh);
    if (testing::Test::HasFatalFailure()) FAIL() << "cell " << i;
    tunnels += truth.surfaces < truth.borders;
  }
  EXPECT_GT(decided, 0.9 * cells);
  EXPECT_GT(tunnels, 30);
}

// Draws cells until each of Chernyaev's cases with a tunnel has occurred often.
TEST(ContourTopology, EveryKindOfTunnelOccurs) {
  Random random(3);
  std::map<std::multiset<std::size_t>, int> kinds;
  for (int i = 0; i < 300000; ++i) {
    const Corners g = random_corners(random, i % 3);
    const auto polygons = polygons_of(g);
    if (polygons.size() < 2) continue;
    const IsosurfaceMesh mesh = mesh_of(g);
    const test::Parts parts = test::parts_of(mesh);
    ASSERT_GE(parts.surfaces + 1, parts.borders);
    if (parts.surfaces == parts.borders) continue;
    std::multiset<std::size_t> kind;
    for (const auto& polygon : polygons) kind.insert(polygon.size());
    ++kinds[kind];
    test::expect_manifold(mesh);
    if (testing::Test::HasFatalFailure()) FAIL() << "cell " << i;
  }
  using Kind = std::multiset<std::size_t>;
  for (const Kind& kind : {Kind{3, 3}, {3, 4}, {3, 5}, {3, 6}, {4, 4}, {3, 3, 6}}) {
    EXPECT_GT(kinds[kind], 5);
  }
  EXPECT_EQ(kinds.size(), 6u);
}

// Every case of a cell, and of two adjacent cells, occurs here many times.
TEST(ContourTopology, NoiseIsAClosedManifold) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const IsosurfaceMesh mesh = contour(test::noise<3>(18, seed, -1.0), 0.5);
    EXPECT_GT(mesh.triangles.size(), 5000u);
    EXPECT_TRUE(test::closed(mesh)) << "seed " << seed;
    EXPECT_GT(test::signed_volume(mesh), 0) << "seed " << seed;
    test::expect_manifold(mesh);
    if (testing::Test::HasFatalFailure()) FAIL() << "seed " << seed;
  }
}

// Integer values, as in most files, make degenerate cells: saddles at the isovalue, saddles that
// are lines, and edges that meet at a corner.
TEST(ContourTopology, IntegersAreAClosedManifold) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Random random(seed);
    const Field<3> field = test::sampled<3>(16, [&](const Vec3& x) {
      const double h = std::floor(5 * random.uniform());
      for (int a = 0; a < 3; ++a) {
        if (x[a] == 0 || x[a] == 1) return -1.0;
      }
      return h;
    });
    for (const double c : {0.0, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0}) {
      const IsosurfaceMesh mesh = contour(field, c);
      EXPECT_TRUE(test::closed(mesh)) << "isovalue " << c;
      for (const auto& v : mesh.vertices) ASSERT_TRUE(std::isfinite(v.x + v.y + v.z));
      test::expect_manifold(mesh);
      if (testing::Test::HasFatalFailure()) FAIL() << "seed " << seed << " isovalue " << c;
    }
  }
}

TEST(ContourTopology, VerticesLieOnTheIsosurfaceInTheirCells) {
  const Field<3> field = test::noise<3>(18, 3, -1.0);
  const MarchingCubes cubes(field, 0.5);
  IsosurfaceMesh mesh;
  cubes.fill(mesh, false);
  std::size_t inside = 0;
  for (const auto& vertex : mesh.vertices) {
    const CellPoint<3> at = locate(field, field.world_to_index.point(Vec3(vertex)));
    ASSERT_NEAR(interpolate(load_corners(field, at.cell), at.local), 0.5, 1e-5);
    int between = 0;
    for (int a = 0; a < 3; ++a) between += std::abs(at.local[a] - std::round(at.local[a])) > 1e-5;
    inside += between > 1;
  }
  EXPECT_GT(inside, 50u);
  EXPECT_LT(inside, mesh.vertices.size() / 20);
}

TEST(ContourTopology, IsTheSameForAnyNumberOfThreads) {
  const Field<3> field = test::noise<3>(40, 8, -1.0);
  IsosurfaceMesh first;
  for (const int threads : {1, 2}) {
    tbb::task_arena arena(threads);
    arena.execute([&] {
      const IsosurfaceMesh mesh = contour(field, 0.5);
      if (threads == 1) first = mesh;
      EXPECT_EQ(mesh.vertices, first.vertices);
      EXPECT_EQ(mesh.normals, first.normals);
      EXPECT_EQ(mesh.triangles, first.triangles);
    });
  }
}

// A reused mesh must not depend on its earlier content, nor its triangles on the computation of
// normals.
TEST(ContourTopology, MemoryIsUsedAgain) {
  const Field<3> field = test::noise<3>(18, 8, -1.0);
  IsosurfaceMesh mesh;
  for (const double c : {0.5, 0.9, 0.2, 0.5}) {
    const IsosurfaceMesh fresh = contour(field, c);
    MarchingCubes(field, c).fill(mesh, c > 0.4);
    EXPECT_EQ(mesh.vertices, fresh.vertices);
    EXPECT_EQ(mesh.triangles, fresh.triangles);
    const bool normals = c > 0.4;
    EXPECT_EQ(mesh.normals, normals ? fresh.normals : decltype(fresh.normals){});
  }
}

// The callback must receive each vertex of the mesh once, at its position.
TEST(ContourTopology, VisitsEachVertexOnce) {
  const Field<3> field = test::noise<3>(18, 8, -1.0);
  const MarchingCubes cubes(field, 0.5);
  std::vector<Vec3> visited(cubes.vertices());
  std::vector<int> times(cubes.vertices(), 0);
  IsosurfaceMesh mesh;
  cubes.fill(mesh, false, [&](std::size_t first, const std::vector<Vec3>& positions) {
    for (std::size_t n = 0; n < positions.size(); ++n) {
      visited[first + n] = positions[n];
      ++times[first + n];
    }
  });
  ASSERT_EQ(mesh.vertices.size(), visited.size());
  for (std::size_t v = 0; v < visited.size(); ++v) {
    ASSERT_EQ(times[v], 1);
    ASSERT_EQ(mesh.vertices[v], (Vec<3, float>(field.index_to_world.point(visited[v]))));
  }
}

}  // namespace
}  // namespace leaflight

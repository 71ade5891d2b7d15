// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/cell_triangles.h"

#include <algorithm>
#include <deque>
#include <limits>
#include <vector>

#include "surface/cell_polygons.h"
#include "surface/cell_tunnels.h"

namespace leaflight {
namespace {

using Polygon = std::vector<int>;
using Triangle = std::array<int, 3>;

// Returns the faces that contain an edge, one bit each.
unsigned faces_of(int edge) {
  const auto [axis, corner] = cell_edge(edge);
  unsigned faces = 0;
  for (int a = 0; a < 3; ++a) {
    if (a != axis) faces |= 1u << (2 * a + ((corner >> a) & 1));
  }
  return faces;
}

// Returns four times the squared distance between the midpoints of two edges.
int squared_distance(int e, int f) {
  const CellEdge first = cell_edge(e), second = cell_edge(f);
  int sum = 0;
  for (int a = 0; a < 3; ++a) {
    const auto twice = [a](const CellEdge& edge) {
      return 2 * ((edge.corner >> a) & 1) + (edge.axis == a);
    };
    sum += (twice(first) - twice(second)) * (twice(first) - twice(second));
  }
  return sum;
}

// The additional sides that triangles may have between the points of two edges.
class Diagonals {
 public:
  Diagonals() {
    for (int e = 0; e < 12; ++e) {
      for (int f = 0; f < 12; ++f) allowed_[e][f] = (faces_of(e) & faces_of(f)) == 0;
    }
  }
  bool allowed(int e, int f) const { return allowed_[e][f]; }
  void forbid(int e, int f) { allowed_[e][f] = allowed_[f][e] = false; }

 private:
  std::array<std::array<bool, 12>, 12> allowed_;
};

// The triangles of a polygon, in its opposite orientation.
struct Cover {
  std::vector<Triangle> triangles;
  int inside = 0;  // points inside the cell, numbered from 12
  int length = 0;  // of the diagonals
  bool better_than(const Cover& other) const {
    return inside != other.inside ? inside < other.inside : length < other.length;
  }
};

constexpr int impossible = std::numeric_limits<int>::max();

// The triangulation of a polygon by the shortest diagonals.
class ShortestDiagonals {
 public:
  ShortestDiagonals(const Polygon& polygon, const Diagonals& diagonals)
      : polygon_(polygon), diagonals_(diagonals), n_(static_cast<int>(polygon.size())) {
    length_.assign(n_ * n_, 0);
    apex_.assign(n_ * n_, -1);
    for (int width = 2; width < n_; ++width) {
      for (int i = 0; i + width < n_; ++i) fill(i, i + width);
    }
  }
  int length() const { return length_[n_ - 1]; }
  void append(std::vector<Triangle>& triangles) const { append(0, n_ - 1, triangles); }

 private:
  int side(int i, int j) const {
    if (j == i + 1 || (i == 0 && j == n_ - 1)) return 0;
    if (!diagonals_.allowed(polygon_[i], polygon_[j])) return impossible;
    return squared_distance(polygon_[i], polygon_[j]);
  }
  void fill(int i, int j) {
    int best = impossible;
    if (side(i, j) != impossible) {
      for (int k = i + 1; k < j; ++k) {
        const int left = length_[i * n_ + k], right = length_[k * n_ + j];
        if (left == impossible || right == impossible || left + right + side(i, j) >= best)
          continue;
        best = left + right + side(i, j);
        apex_[i * n_ + j] = k;
      }
    }
    length_[i * n_ + j] = best;
  }
  void append(int i, int j, std::vector<Triangle>& triangles) const {
    if (j < i + 2) return;
    const int k = apex_[i * n_ + j];
    triangles.push_back({polygon_[i], polygon_[j], polygon_[k]});
    append(i, k, triangles);
    append(k, j, triangles);
  }

  const Polygon& polygon_;
  const Diagonals& diagonals_;
  const int n_;
  std::vector<int> length_, apex_;
};

// Triangulates a polygon by a fan from its first corner, if it is allowed. Otherwise uses the
// shortest diagonals, or else a fan from the given point inside the cell.
Cover cover(const Polygon& polygon, const Diagonals& diagonals, int point) {
  const std::size_t n = polygon.size();
  Cover found;
  bool fan = true;
  for (std::size_t i = 2; i + 1 < n; ++i) fan = fan && diagonals.allowed(polygon[0], polygon[i]);
  if (fan) {
    for (std::size_t i = 1; i + 1 < n; ++i) {
      found.triangles.push_back({polygon[0], polygon[i + 1], polygon[i]});
      if (i > 1) found.length += squared_distance(polygon[0], polygon[i]);
    }
    return found;
  }
  const ShortestDiagonals shortest(polygon, diagonals);
  if (shortest.length() != impossible) {
    shortest.append(found.triangles);
    found.length = shortest.length();
    return found;
  }
  for (std::size_t i = 0; i < n; ++i) {
    found.triangles.push_back({point, polygon[(i + 1) % n], polygon[i]});
  }
  found.inside = 1;
  return found;
}

// Appends the corners of a polygon from one to another.
void append_arc(const Polygon& polygon, std::size_t from, std::size_t to, Polygon& arc) {
  for (std::size_t i = from;; i = (i + 1) % polygon.size()) {
    arc.push_back(polygon[i]);
    if (i == to) return;
  }
}

// Returns the tunnel between two polygons: two bridges split it into two polygons.
Cover tunnel(const Polygon& a, const Polygon& b, int point) {
  const Diagonals diagonals;
  Cover best;
  best.inside = impossible;
  // Try all pairs of bridges, from a1 to b1 and from a2 to b2.
  for (std::size_t a1 = 0; a1 < a.size(); ++a1) {
    for (std::size_t b1 = 0; b1 < b.size(); ++b1) {
      for (std::size_t a2 = a1 + 1; a2 < a.size(); ++a2) {
        for (std::size_t b2 = 0; b2 < b.size(); ++b2) {
          if (b1 == b2 || !diagonals.allowed(a[a1], b[b1]) || !diagonals.allowed(a[a2], b[b2])) {
            continue;
          }
          // Split the polygons at the bridges.
          Polygon halves[2];
          append_arc(a, a1, a2, halves[0]);
          append_arc(b, b2, b1, halves[0]);
          append_arc(a, a2, a1, halves[1]);
          append_arc(b, b1, b2, halves[1]);
          // Diagonals that both halves could use belong to the first.
          Diagonals rest = diagonals;
          Cover joined_cover;
          for (const Polygon& half : halves) {
            const Cover part = cover(half, rest, point + joined_cover.inside);
            joined_cover.triangles.insert(joined_cover.triangles.end(), part.triangles.begin(),
                                          part.triangles.end());
            joined_cover.inside += part.inside;
            joined_cover.length += part.length;
            for (const int e : {a[a1], a[a2], b[b1], b[b2]}) {
              for (const int f : {a[a1], a[a2], b[b1], b[b2]}) rest.forbid(e, f);
            }
          }
          joined_cover.length += squared_distance(a[a1], b[b1]) + squared_distance(a[a2], b[b2]);
          if (joined_cover.better_than(best)) best = joined_cover;
        }
      }
    }
  }
  return best;
}

// Upper bound on the corners of two polygons with a tunnel. Only Chernyaev's cases 4, 6, 7, 10, 12
// and 13.5 (1995) have a tunnel.
constexpr std::size_t too_many_for_tunnel = 10;

// The triangles of a case without a tunnel, and with one between each pair of its polygons.
struct Case {
  struct Pair {
    int first, second;  // polygons
    CellTriangles triangles;
  };
  std::vector<CellEdge> polygons;  // a crossed edge of each polygon
  CellTriangles separate;
  std::vector<Pair> tunnels;
};

class Table {
 public:
  Table() : number_(256 * 64, 0) {
    for (unsigned above = 0; above < 256; ++above) {
      const unsigned alternating = alternating_faces(above);
      for (unsigned joined = 0; joined < 64; ++joined) {
        if ((joined & ~alternating) == 0) append_case(above, joined);
      }
      if (alternating == 0 && case_for(above, 0).polygons.size() == 1) {
        plain_[above] = case_for(above, 0).separate;
      }
    }
  }

  const std::array<CellTriangles, 256>& plain() const { return plain_; }
  const Case& case_for(unsigned above, unsigned joined) const {
    return cases_[number_[64 * above + joined]];
  }

 private:
  void append_case(unsigned above, unsigned joined) {
    number_[64 * above + joined] = static_cast<std::uint16_t>(cases_.size());
    Case& added = cases_.emplace_back();
    const std::vector<Polygon> polygons = cell_polygons(above, joined);
    const int n = static_cast<int>(polygons.size());
    std::vector<Cover> covers;
    int inside = 0;
    for (const Polygon& polygon : polygons) {
      added.polygons.push_back(cell_edge(polygon[0]));
      covers.push_back(cover(polygon, Diagonals(), 12 + inside));
      inside += covers.back().inside;
    }
    added.separate = kept(covers);
    for (int i = 0; i < n; ++i) {
      for (int j = i + 1; j < n; ++j) {
        if (polygons[i].size() + polygons[j].size() >= too_many_for_tunnel) continue;
        std::vector<Cover> parts{tunnel(polygons[i], polygons[j], 12)};
        int points = parts[0].inside;
        for (int k = 0; k < n; ++k) {
          if (k == i || k == j) continue;
          parts.push_back(cover(polygons[k], Diagonals(), 12 + points));
          points += parts.back().inside;
        }
        added.tunnels.push_back({i, j, kept(parts)});
      }
    }
  }

  // Stores triangles for the lifetime of the table.
  CellTriangles kept(const std::vector<Cover>& covers) {
    std::vector<std::uint8_t>& corners = corners_.emplace_back();
    int inside = 0;
    for (const Cover& part : covers) {
      for (const Triangle& triangle : part.triangles) {
        for (const int corner : triangle) corners.push_back(static_cast<std::uint8_t>(corner));
      }
      inside += part.inside;
    }
    return {corners.data(), static_cast<std::uint8_t>(corners.size() / 3),
            static_cast<std::uint8_t>(inside)};
  }

  std::deque<std::vector<std::uint8_t>> corners_;
  std::vector<Case> cases_;
  std::vector<std::uint16_t> number_;  // number of a case in `cases_`
  std::array<CellTriangles, 256> plain_;
};

const Table& table() {
  static const Table all;
  return all;
}

}  // namespace

const std::array<CellTriangles, 256>& plain_triangles() { return table().plain(); }

const CellTriangles& ambiguous_triangles(unsigned above, const std::array<double, 8>& g) {
  const unsigned joined = joined_faces(g, above);
  const Case& found = table().case_for(above, joined);
  if (found.tunnels.empty()) return found.separate;
  const CellSaddles saddles = cell_saddles(g);
  if (saddles.count == 0) return found.separate;
  const auto region = connected_corners(g, above, joined, saddles);
  for (const Case::Pair& pair : found.tunnels) {
    const CellEdge &e = found.polygons[pair.first], &f = found.polygons[pair.second];
    // Two polygons bound one surface if the same regions are on both sides of them.
    const auto sides = [&](const CellEdge& edge) {
      const auto [low, high] =
          std::minmax(region[edge.corner], region[edge.corner | (1 << edge.axis)]);
      return std::array{low, high};
    };
    if (sides(e) == sides(f)) return pair.triangles;
  }
  return found.separate;
}

}  // namespace leaflight

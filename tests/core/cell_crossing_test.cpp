// SPDX-License-Identifier: GPL-3.0-or-later
#include "leaflight/trace/cell_crossing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "fields.h"

namespace leaflight {
namespace {

// The oracle works with 113 bits and finds the roots of a polynomial between those of its
// derivative, recursively, by bisection alone.
using Quad = __float128;

Quad value(const std::vector<Quad>& p, Quad s) {
  Quad sum = 0;
  for (std::size_t i = p.size(); i-- > 0;) sum = sum * s + p[i];
  return sum;
}

std::vector<Quad> sign_changes(const std::vector<Quad>& p) {
  if (p.size() < 2) return {};
  std::vector<Quad> derivative;
  for (std::size_t i = 1; i < p.size(); ++i) derivative.push_back(p[i] * static_cast<int>(i));
  std::vector<Quad> knots = sign_changes(derivative);
  knots.insert(knots.begin(), 0);
  knots.push_back(1);
  std::vector<Quad> roots;
  for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
    Quad low = knots[k], high = knots[k + 1];
    const bool above = value(p, low) >= 0;
    if ((value(p, high) >= 0) == above) continue;
    for (int i = 0; i < 110; ++i) {
      const Quad middle = (low + high) / 2;
      ((value(p, middle) >= 0) == above ? low : high) = middle;
    }
    roots.push_back(high);
  }
  return roots;
}

template <int D>
std::vector<Quad> exact_polynomial(const CellCorners<D>& corners, double c, const Vec<D>& from,
                                   const Vec<D>& to) {
  std::vector<Quad> p(D + 1, 0);
  for (int corner = 0; corner < (1 << D); ++corner) {
    std::vector<Quad> term{static_cast<Quad>(corners.h[corner]) - static_cast<Quad>(c)};
    for (int a = 0; a < D; ++a) {
      const Quad step = static_cast<Quad>(to[a]) - static_cast<Quad>(from[a]);
      const bool high = (corner >> a) & 1;
      const Quad constant = high ? static_cast<Quad>(from[a]) : 1 - static_cast<Quad>(from[a]);
      const Quad slope = high ? step : -step;
      std::vector<Quad> product(term.size() + 1, 0);
      for (std::size_t i = 0; i < term.size(); ++i) {
        product[i] += term[i] * constant;
        product[i + 1] += term[i] * slope;
      }
      term = product;
    }
    for (std::size_t i = 0; i < term.size(); ++i) p[i] += term[i];
  }
  return p;
}

// How near to a tie the segment is: the least |h - c| at its ends and critical points, relative to
// the range of the corners.
double distance_to_tie(const std::vector<Quad>& p, double range) {
  std::vector<Quad> derivative;
  for (std::size_t i = 1; i < p.size(); ++i) derivative.push_back(p[i] * static_cast<int>(i));
  std::vector<Quad> places = sign_changes(derivative);
  places.push_back(0);
  places.push_back(1);
  double least = 1;
  for (const Quad s : places) {
    least = std::min(least, std::abs(static_cast<double>(value(p, s))) / range);
  }
  return least;
}

template <int D>
Vec<D> face_point(Random& random, int axis, double at) {
  Vec<D> p;
  for (int a = 0; a < D; ++a) p[a] = a == axis ? at : random.uniform();
  return p;
}

template <int D>
struct Comparison {
  int hits = 0, missed = 0, invented = 0, ties = 0;
  double worst_position = 0;

  void add(const CellCorners<D>& corners, double c, const Vec<D>& from, const Vec<D>& to) {
    const auto exact = exact_polynomial<D>(corners, c, from, to);
    double low = corners.h[0], high = corners.h[0];
    for (const double h : corners.h) low = std::min(low, h), high = std::max(high, h);
    const double range = std::max({high - low, std::abs(high - c), std::abs(low - c)});
    if (!(range > 0) || distance_to_tie(exact, range) < 1e-13) {
      ++ties;
      return;
    }
    const auto truth = sign_changes(exact);
    const auto found = first_crossing(along_segment<D>(corners, c, from, to), value(exact, 0) >= 0);
    hits += !truth.empty();
    missed += !truth.empty() && !found;
    invented += truth.empty() && found;
    if (truth.empty() || !found) return;
    // In h, since the position of a grazing root is ill-conditioned.
    const double residual =
        std::abs(static_cast<double>(value(exact, static_cast<Quad>(*found)))) / range;
    worst_position = std::max(worst_position, residual);
    // The first of several crossings, not a later one.
    for (const Quad root : truth) {
      if (static_cast<double>(root) < *found - 1e-6) ++missed;
      break;
    }
  }
};

enum class Kind { random, smooth, plateau, constant };

template <int D>
Comparison<D> compare(Kind kind, int trials) {
  Random random(7 + static_cast<int>(kind) + 10 * D);
  Comparison<D> result;
  for (int i = 0; i < trials; ++i) {
    CellCorners<D> corners;
    Vec<D> slope;
    for (int a = 0; a < D; ++a) slope[a] = random.uniform() - 0.5;
    for (int k = 0; k < (1 << D); ++k) {
      double h = 0.7;
      if (kind == Kind::random) h = random.uniform() * 2 - 1;
      if (kind == Kind::plateau) h = static_cast<int>(random.uniform() * 3) - 1;
      if (kind == Kind::smooth) {
        h = 0.05 * (random.uniform() - 0.5);
        for (int a = 0; a < D; ++a) h += slope[a] * ((k >> a) & 1);
      }
      corners.h[k] = static_cast<float>(h);
    }
    double c = kind == Kind::random    ? 0
               : kind == Kind::plateau ? (i % 3) * 0.5 - 0.5
                                       : (random.uniform() - 0.5);
    const int axis = static_cast<int>(random.uniform() * D);
    const int other = static_cast<int>(random.uniform() * D);
    const Vec<D> from = face_point<D>(random, axis, random.uniform() < 0.5 ? 0 : 1);
    const Vec<D> to = face_point<D>(random, other, random.uniform() < 0.5 ? 0 : 1);
    result.add(corners, c, from, to);
  }
  return result;
}

template <int D>
void expect_exact(Kind kind, int least_hits) {
  const auto result = compare<D>(kind, 100'000);
  EXPECT_EQ(result.missed, 0);
  EXPECT_EQ(result.invented, 0);
  EXPECT_GE(result.hits, least_hits);
  EXPECT_LT(result.worst_position, 1e-13);
  EXPECT_LT(result.ties, kind == Kind::plateau ? 70'000 : 100);
}

TEST(CellCrossing, RandomCells) {
  expect_exact<3>(Kind::random, 30'000);
  expect_exact<2>(Kind::random, 30'000);
}

TEST(CellCrossing, SmoothCells) {
  expect_exact<3>(Kind::smooth, 15'000);
  expect_exact<2>(Kind::smooth, 15'000);
}

TEST(CellCrossing, PlateauCells) {
  expect_exact<3>(Kind::plateau, 20'000);
  expect_exact<2>(Kind::plateau, 10'000);
}

TEST(CellCrossing, ConstantCellsHaveNoCrossing) {
  expect_exact<3>(Kind::constant, 0);
  CellCorners<3> corners;
  corners.h.fill(3.0);
  const auto p = along_segment<3>(corners, 3.0, Vec3(0.0), Vec3(1.0));
  EXPECT_FALSE(first_crossing(p, true)) << "h == c everywhere counts as above";
}

TEST(CellCrossing, TouchingFromAboveIsNoCrossing) {
  // (s - 1/2)^2 touches zero, which counts as above.
  EXPECT_FALSE(first_crossing({0.25, -1, 1, 0}, true));
  // -(s - 1/2)^2 reaches zero from below: the touching point is above.
  const auto touch = first_crossing({-0.25, 1, -1, 0}, false);
  ASSERT_TRUE(touch);
  EXPECT_NEAR(*touch, 0.5, 1e-7);  // a double root is known to half the digits
}

TEST(CellCrossing, ThreeRootsGiveTheFirst) {
  // (s - 0.1)(s - 0.5)(s - 0.9)
  const auto found = first_crossing({-0.045, 0.59, -1.5, 1}, false);
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found, 0.1, 1e-15);
}

TEST(CellCrossing, GivenSideWinsOverRounding) {
  // The start was judged above; the polynomial is below from its first point on.
  const auto found = first_crossing({-1e-18, -1, 0, 0}, true);
  ASSERT_TRUE(found);
  EXPECT_LT(*found, 1e-15);
}

}  // namespace
}  // namespace leaflight

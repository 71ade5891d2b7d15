// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact.h"
#include "figures.h"
#include "trace/cell_crossing.h"

namespace leaflight {
namespace {

using test::ExactPolynomial;
using test::Quad;

// Tolerance for ties: values closer to the isovalue than this, relative to the range of the
// corners, may count as equal. It is 64 roundings of doubles, of 1.1e-16 each.
constexpr double tie = 7e-15;

template <int D>
struct Segment {
  CellCorners<D> corners;
  double c = 0;
  Vec<D> from, to;

  ExactPolynomial exact() const {
    return test::exact_polynomial<D>(corners, c, test::exact_point<D>(from),
                                     test::exact_point<D>(to));
  }
  double range() const {
    const auto [low, high] = std::minmax_element(corners.h.begin(), corners.h.end());
    return std::max({*high - *low, std::abs(*high - c), std::abs(*low - c)});
  }
};

struct Count {
  std::int64_t cells = 0, hits = 0, missed = 0, invented = 0, ties = 0;
  double worst_residual = 0;
};

// Compares a crossing with the exact one. If the ends of the segment are exact, tests the rule for
// ties there, too.
template <int D>
void compare(const Segment<D>& segment, bool exact_ends, Count& count) {
  const ExactPolynomial p = segment.exact();
  const double range = segment.range();
  if (!(range > 0)) return;
  ++count.cells;
  const bool above = p[0] >= 0;
  test::CrossingSearch search(above);
  for (const Quad s : test::monotone_knots(p)) {
    const bool end = s == 0 || s == 1;
    const Quad tolerance = (end && exact_ends) || s == 0 ? 0 : tie * range;
    if (search.add(static_cast<double>(s), test::value(p, s), tolerance)) break;
  }
  const test::ExactCrossing& truth = search.crossing();
  const auto found =
      first_crossing(along_segment<D>(segment.corners, segment.c, segment.from, segment.to), above);
  count.hits += truth.required();
  count.ties += truth.tie();
  // Critical points bracket the roots. They have half of the digits where two nearly coincide.
  constexpr double slack = 1e-7;
  count.missed += truth.required() && !(found && *found <= truth.latest + slack);
  count.invented += found && !(truth.possible() && *found >= truth.earliest - slack);
  if (!found) return;
  // Compare h, because the position of a grazing root is ill-conditioned.
  const Quad residual = test::magnitude(test::value(p, static_cast<Quad>(*found))) / range;
  count.worst_residual = std::max(count.worst_residual, static_cast<double>(residual));
}

template <int D>
Vec<D> face_point(Random& random) {
  Vec<D> p;
  for (int a = 0; a < D; ++a) p[a] = random.uniform();
  p[static_cast<int>(random.uniform() * D)] = random.uniform() < 0.5 ? 0 : 1;
  return p;
}

template <int D, class Height>
Segment<D> segment_of(Random& random, double c, Height h) {
  Segment<D> segment;
  for (int k = 0; k < (1 << D); ++k) segment.corners.h[k] = static_cast<float>(h(k));
  segment.c = c;
  segment.from = face_point<D>(random);
  segment.to = face_point<D>(random);
  return segment;
}

double signed_unit(Random& random) { return 2 * random.uniform() - 1; }

// Returns a number of random sign. Its magnitude is uniform over the decades from 10^-decades to 1.
double any_magnitude(Random& random, double decades) {
  const double size = std::pow(10.0, -decades * random.uniform());
  return random.uniform() < 0.5 ? -size : size;
}

template <int D>
Segment<D> random_cell(Random& random) {
  return segment_of<D>(random, 0, [&](int) { return signed_unit(random); });
}

template <int D>
Segment<D> smooth_cell(Random& random) {
  Vec<D> slope;
  for (int a = 0; a < D; ++a) slope[a] = random.uniform() - 0.5;
  return segment_of<D>(random, random.uniform() - 0.5, [&](int k) {
    double h = 0.05 * (random.uniform() - 0.5);
    for (int a = 0; a < D; ++a) h += slope[a] * ((k >> a) & 1);
    return h;
  });
}

template <int D>
Segment<D> plateau_cell(Random& random) {
  const double c = static_cast<int>(random.uniform() * 3) * 0.5 - 0.5;
  return segment_of<D>(random, c, [&](int) { return static_cast<int>(random.uniform() * 3) - 1; });
}

// Corners alternate about the isovalue, which is close to the value of the saddle.
template <int D>
Segment<D> saddle_cell(Random& random) {
  const double noise = any_magnitude(random, 6);
  return segment_of<D>(random, any_magnitude(random, 12), [&](int k) {
    int bits = 0;
    for (int a = 0; a < D; ++a) bits += (k >> a) & 1;
    return (bits % 2 ? 1 : -1) + noise * signed_unit(random);
  });
}

// The isovalue is equal or close to a critical value along the segment.
template <int D>
Segment<D> double_root_cell(Random& random) {
  for (;;) {
    Segment<D> segment = random_cell<D>(random);
    const ExactPolynomial p = segment.exact();
    const std::vector<Quad> knots = test::monotone_knots(p);
    if (knots.size() < 3) continue;
    segment.c = static_cast<double>(test::value(p, knots[1])) + any_magnitude(random, 16);
    return segment;
  }
}

// Values are small integers and multiples of 1/8, so that doubles hold every intermediate result
// exactly.
template <int D>
Segment<D> exact_cell(Random& random) {
  const double c = static_cast<int>(random.uniform() * 9) * 0.5 - 2;
  Segment<D> segment =
      segment_of<D>(random, c, [&](int) { return static_cast<int>(random.uniform() * 5) - 2; });
  for (int a = 0; a < D; ++a) {
    segment.from[a] = std::round(segment.from[a] * 8) / 8;
    segment.to[a] = std::round(segment.to[a] * 8) / 8;
  }
  return segment;
}

template <class Cell>
void expect_none_missed(const std::string& kind, Cell cell, double least_hits, double most_ties,
                        bool exact_ends = false) {
  const std::int64_t cells = test::trials(100'000, 10'000'000);
  Random random(41);
  Count count;
  for (std::int64_t i = 0; i < cells; ++i) compare(cell(random), exact_ends, count);
  EXPECT_EQ(count.missed, 0);
  EXPECT_EQ(count.invented, 0);
  EXPECT_GE(count.hits, least_hits * cells);
  EXPECT_LE(count.ties, most_ties * cells);
  // A root is a sign change of the rounded polynomial.
  EXPECT_LT(count.worst_residual, tie);
  test::figure(kind + ": cells", count.cells);
  test::figure(kind + ": hits", count.hits);
  test::figure(kind + ": missed", count.missed);
  test::figure(kind + ": invented", count.invented);
  test::figure(kind + ": ties", count.ties);
  test::figure(kind + ": worst |h - c| / range", count.worst_residual);
}

TEST(NumericsCells, Random) {
  expect_none_missed("random 3D", random_cell<3>, 0.3, 1e-3);
  expect_none_missed("random 2D", random_cell<2>, 0.3, 1e-3);
}

TEST(NumericsCells, Smooth) {
  expect_none_missed("smooth 3D", smooth_cell<3>, 0.1, 1e-3);
  expect_none_missed("smooth 2D", smooth_cell<2>, 0.1, 1e-3);
}

TEST(NumericsCells, Plateau) {
  expect_none_missed("plateau 3D", plateau_cell<3>, 0.2, 0.1);
  expect_none_missed("plateau 2D", plateau_cell<2>, 0.1, 0.1);
}

TEST(NumericsCells, Saddle) {
  expect_none_missed("saddle 3D", saddle_cell<3>, 0.3, 1e-3);
  expect_none_missed("saddle 2D", saddle_cell<2>, 0.3, 1e-3);
}

TEST(NumericsCells, DoubleRoot) {
  expect_none_missed("double root 3D", double_root_cell<3>, 0.2, 0.2);
  expect_none_missed("double root 2D", double_root_cell<2>, 0.2, 0.2);
}

// Ends of the segment have no tolerance: values equal to the isovalue are above.
TEST(NumericsCells, TiesFollowTheRule) {
  expect_none_missed("exact ties 3D", exact_cell<3>, 0.15, 0.1, true);
  expect_none_missed("exact ties 2D", exact_cell<2>, 0.15, 0.1, true);
}

}  // namespace
}  // namespace leaflight

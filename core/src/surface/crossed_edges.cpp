// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/crossed_edges.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <string>

#include "base/error.h"

namespace leaflight {
namespace {

// Calls visit(brick) for the bricks of the lowest level, below a brick of a higher one, whose
// interval contains the isovalue.
template <int D, class Visit>
void visit_crossed(const IntervalPyramid<D>& pyramid, std::size_t level, const Index<D>& brick,
                   double isovalue, const Visit& visit) {
  if (!pyramid.levels[level].at(brick).crossed_by(isovalue)) return;
  if (level == 0) {
    visit(brick);
    return;
  }
  Index<D> low, high;
  for (int a = 0; a < D; ++a) {
    low[a] = brick[a] << IntervalPyramid<D>::log2_brick;
    high[a] = std::min((brick[a] + 1) << IntervalPyramid<D>::log2_brick,
                       pyramid.levels[level - 1].dims[a]);
  }
  for_each_index<D>(low, high, [&](const Index<D>& below) {
    visit_crossed(pyramid, level - 1, below, isovalue, visit);
  });
}

}  // namespace

template <int D>
CrossedEdges<D>::CrossedEdges(const Field<D>& field, double isovalue)
    : field_(field), isovalue_(isovalue), level_(field.pyramid->levels[0]) {
  for (int a = 0; a < D; ++a) {
    along_[a] = Vec<D>(0.0);
    along_[a][a] = 1;
  }
  constexpr std::int32_t absent = -1, present = 0;
  place_.assign(level_.bricks.size(), absent);
  std::size_t found = 0;
  visit_crossed(*field_.pyramid, field_.pyramid->levels.size() - 1, Index<D>{}, isovalue_,
                [&](const Index<D>& brick) {
                  Index<D> end;
                  for (int a = 0; a < D; ++a) end[a] = std::min(brick[a] + 2, level_.dims[a]);
                  for_each_index<D>(brick, end, [&](const Index<D>& owner) {
                    std::int32_t& place = place_[linear_number<D>(owner, level_.dims)];
                    found += place == absent;
                    place = present;
                  });
                });
  bricks_.reserve(found);
  for (std::size_t i = 0; i < place_.size(); ++i) {
    if (place_[i] == absent) continue;
    place_[i] = static_cast<std::int32_t>(bricks_.size());
    bricks_.push_back({index_of<D>(i, level_.dims)});
  }
}

template <int D>
void CrossedEdges<D>::mark(const Visit& visit) {
  constexpr std::size_t grain = 64, ahead = 2;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, bricks_.size(), grain), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
          if (i + ahead < bricks_.size()) fetch_brick(field_, bricks_[i + ahead].brick);
          const BrickValues<D> values = load_brick(field_, bricks_[i].brick, isovalue_);
          for (int a = 0; a < D; ++a) bricks_[i].edges[a] = values.crossed_edges(a);
          if (visit) visit(i, values);
        }
      });
  std::int64_t vertices = 0;
  for (BrickEdges& e : bricks_) {
    e.first = vertices;
    vertices += e.count();
  }
  if (vertices > std::numeric_limits<std::int32_t>::max()) {
    throw Error("The isosurface has " + std::to_string(vertices) +
                " vertices, more than a mesh can hold; reduce the volume's resolution.");
  }
  count_ = static_cast<std::size_t>(vertices);
}

template class CrossedEdges<2>;
template class CrossedEdges<3>;

}  // namespace leaflight

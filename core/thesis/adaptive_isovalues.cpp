// SPDX-License-Identifier: GPL-3.0-or-later
#include "thesis/adaptive_isovalues.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <string>

#include "base/error.h"

namespace leaflight {
namespace {

struct Span {
  float low, high;
};

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr Span none{infinity, -infinity};

void include(Span& a, const Span& b) {
  a.low = std::min(a.low, b.low);
  a.high = std::max(a.high, b.high);
}

// A subset of a field's voxels, and the values within a distance of each.
template <int D>
class Neighborhoods {
 public:
  Neighborhoods(const Field<D>& field, int points_per_axis) {
    Index<D> stride;
    for (int a = 0; a < D; ++a) {
      stride[a] = (field.dims[a] + points_per_axis - 3) / (points_per_axis - 1);
      dims_[a] = (field.dims[a] - 1) / stride[a] + 1;
      spacing_[a] = field.index_to_world.column[a].length() * stride[a];
    }
    values_.reserve(cell_count<D>(dims_));
    for_each_index<D>({}, dims_, [&](Index<D> i) {
      for (int a = 0; a < D; ++a) i[a] *= stride[a];
      values_.push_back(field.value(i));
    });
    // Compute spans of runs of 2^level values along axis 0; any run is the union of two.
    std::vector<Span> runs;
    for (const float h : values_) runs.push_back(std::isnan(h) ? none : Span{h, h});
    for (int length = 1; length <= dims_[0]; length *= 2) {
      runs_.push_back(runs);
      for (std::size_t i = 0; i < runs.size(); ++i) {
        if (static_cast<int>(i % dims_[0]) + length < dims_[0])
          include(runs[i], runs_.back()[i + length]);
      }
    }
  }

  const std::vector<float>& values() const { return values_; }

  double smallest_distance() const {
    double d = spacing_[0];
    for (int a = 1; a < D; ++a) d = std::min(d, spacing_[a]);
    return d;
  }

  // Returns the span of the values within a ball around each point.
  std::vector<Span> within(double radius) const {
    std::vector<Index<D>> rows;  // offsets of rows; axis 0 has half the length of a row
    Index<D> low{}, high{};
    high[0] = 1;
    for (int a = 1; a < D; ++a) {
      const int reach = std::min(dims_[a] - 1, static_cast<int>(radius / spacing_[a]));
      low[a] = -reach;
      high[a] = reach + 1;
    }
    for_each_index<D>(low, high, [&](Index<D> offset) {
      double rest = radius * radius;
      for (int a = 1; a < D; ++a) rest -= std::pow(offset[a] * spacing_[a], 2);
      if (rest < 0) return;
      offset[0] = static_cast<int>(std::min<double>(dims_[0], std::sqrt(rest) / spacing_[0]));
      rows.push_back(offset);
    });
    std::vector<Span> spans(values_.size(), none);
    tbb::parallel_for(std::size_t{0}, values_.size() / dims_[0], [&](std::size_t line) {
      const Index<D> first = index_of<D>(line * dims_[0], dims_);
      for (const Index<D>& row : rows) {
        Index<D> other = first;
        bool valid = true;
        for (int a = 1; a < D; ++a) {
          other[a] += row[a];
          valid = valid && other[a] >= 0 && other[a] < dims_[a];
        }
        if (!valid) continue;
        const std::size_t base = linear_number<D>(other, dims_);
        for (int x = 0; x < dims_[0]; ++x) {
          const int begin = std::max(0, x - row[0]);
          const int end = std::min(dims_[0], x + row[0] + 1);
          int level = 0;
          while ((2 << level) <= end - begin) ++level;
          Span& span = spans[line * dims_[0] + x];
          include(span, runs_[level][base + begin]);
          include(span, runs_[level][base + end - (1 << level)]);
        }
      }
    });
    return spans;
  }

 private:
  Index<D> dims_;
  Vec<D> spacing_;
  std::vector<float> values_;
  std::vector<std::vector<Span>> runs_;
};

// Returns the fewest isovalues, ascending, such that each interval (low, high] contains one.
std::vector<double> stab(std::vector<Span> intervals) {
  std::sort(intervals.begin(), intervals.end(),
            [](const Span& a, const Span& b) { return a.high < b.high; });
  std::vector<double> isovalues;
  // Intersection of the intervals of a group.
  Span shared{-infinity, -infinity};
  for (const Span& i : intervals) {
    if (i.low < shared.high) {
      shared.low = std::max(shared.low, i.low);
      continue;
    }
    if (shared.high > shared.low) isovalues.push_back((double{shared.low} + shared.high) / 2);
    shared = i;
  }
  if (shared.high > shared.low) isovalues.push_back((double{shared.low} + shared.high) / 2);
  return isovalues;
}

// Adds remaining isovalues where most values lie between adjacent ones.
void fill(std::vector<double>& isovalues, std::vector<float> values, int count) {
  std::sort(values.begin(), values.end());
  while (static_cast<int>(isovalues.size()) < count) {
    auto begin = values.begin(), best = begin;
    std::ptrdiff_t most = -1;
    for (std::size_t i = 0; i <= isovalues.size(); ++i) {
      const auto end =
          i < isovalues.size() ? std::lower_bound(begin, values.end(), isovalues[i]) : values.end();
      if (end - begin > most) most = end - begin, best = begin;
      begin = end;
    }
    const double c = most > 0 ? double{best[most / 2]} : isovalues.back();
    isovalues.insert(std::upper_bound(isovalues.begin(), isovalues.end(), c), c);
  }
}

}  // namespace

template <int D>
std::vector<double> adaptive_isovalues(const Field<D>& field, const IsovalueRange& isovalue_range,
                                       int count) {
  if (count < 1) {
    throw Error("The number of isovalues is " + std::to_string(count) + "; choose at least 1.");
  }
  // Resolve the distances between the isosurfaces; wide searches are cheap on a coarse grid.
  const Neighborhoods<D> neighborhoods(field, std::clamp(16 * (count + 1), 32, D == 3 ? 64 : 256));
  // Compute balls for whole multiples of the grid's spacing, and interpolate their spans. Otherwise
  // the isovalues would be as uneven as the grid.
  std::map<int, std::vector<Span>> balls;
  const auto ball = [&](int radius) -> const std::vector<Span>& {
    const auto found = balls.find(radius);
    if (found != balls.end()) return found->second;
    return balls[radius] = neighborhoods.within(radius * neighborhoods.smallest_distance());
  };
  const auto isovalues_within = [&](double radius) {
    const int steps = static_cast<int>(radius);
    const auto part = static_cast<float>(radius - steps);
    const std::vector<Span>&back = ball(steps), &front = ball(steps + 1);
    std::vector<Span> intervals;
    for (std::size_t i = 0; i < back.size(); ++i) {
      const float h = neighborhoods.values()[i];
      if (std::isnan(h) || !isovalue_range.contains(h)) continue;
      const float least = back[i].low + part * (front[i].low - back[i].low);
      const float greatest = back[i].high + part * (front[i].high - back[i].high);
      const Span span{std::max(least, static_cast<float>(isovalue_range.min)),
                      std::min(greatest, static_cast<float>(isovalue_range.max))};
      // Constant neighborhoods have no isosurface near them.
      if (span.low < span.high) intervals.push_back(span);
    }
    return stab(std::move(intervals));
  };
  double low = 0, high = 1;
  std::vector<double> best = isovalues_within(high);
  for (; static_cast<int>(best.size()) > count; best = isovalues_within(high)) {
    low = high;
    high *= 1.5;
  }
  for (int i = 0; i < 12; ++i) {
    const double middle = (low + high) / 2;
    std::vector<double> isovalues = isovalues_within(middle);
    const bool enough = !isovalues.empty() && static_cast<int>(isovalues.size()) <= count;
    (enough ? high : low) = middle;
    if (enough) best = std::move(isovalues);
  }
  if (best.empty()) {
    throw Error("No isosurface of the isovalue range passes through the volume; widen it.");
  }
  std::vector<float> values;
  for (const float h : neighborhoods.values()) {
    if (isovalue_range.contains(h)) values.push_back(h);
  }
  fill(best, std::move(values), count);
  return best;
}

template std::vector<double> adaptive_isovalues<2>(const Field<2>&, const IsovalueRange&, int);
template std::vector<double> adaptive_isovalues<3>(const Field<3>&, const IsovalueRange&, int);

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "exact.h"
#include "trace/isosurface_ray.h"

namespace leaflight::test {

// A ray through a field in 113-bit arithmetic, without bounds or traversal. The planes of the grid
// cut the ray into pieces, and each piece lies in the cell of its midpoint.
template <int D>
class ExactRay {
 public:
  ExactRay(const Field<D>& field, const IsosurfaceRay<D>& ray) : field_(field), ray_(ray) {
    position_ = exact_point<D>(ray.position);
    direction_ = exact_point<D>(ray.direction);
    Quad first = 0, last = std::numeric_limits<double>::max();
    for (int a = 0; a < D; ++a) {
      const int planes = field.dims[a];
      if (direction_[a] == 0) {
        if (position_[a] < 0 || position_[a] > planes - 1) last = -1;
        continue;
      }
      Quad low = (0 - position_[a]) / direction_[a];
      Quad high = (planes - 1 - position_[a]) / direction_[a];
      if (low > high) std::swap(low, high);
      first = std::max(first, low);
      last = std::min(last, high);
      for (int k = 0; k < planes; ++k) cuts_.push_back((k - position_[a]) / direction_[a]);
    }
    cuts_.push_back(first);
    cuts_.push_back(last);
    std::sort(cuts_.begin(), cuts_.end());
    cuts_.erase(std::unique(cuts_.begin(), cuts_.end()), cuts_.end());
    cuts_.erase(
        std::remove_if(cuts_.begin(), cuts_.end(), [&](Quad t) { return t < first || t > last; }),
        cuts_.end());
  }

  // False if the ray only touches the domain at an edge or a corner, where rounding decides.
  bool enters() const { return cuts_.size() > 1 && cuts_.back() - cuts_.front() > 1e-12; }
  Quad height_at_entry() const { return piece(0)[0]; }

  // True if a ray that starts on its isosurface leaves towards higher values.
  bool rises() const {
    std::size_t i = 0;
    while (i + 2 < cuts_.size() && cuts_[i + 1] - cuts_[i] < 1e-12) ++i;
    return piece(i)[1] > 0;
  }

  // Finds the first change of side. `tolerance`: of h.
  ExactCrossing first_crossing(double tolerance) const {
    CrossingSearch search(ray_.starts_on_isosurface ? ray_.starts_above : height_at_entry() >= 0);
    for (std::size_t i = 0; i + 1 < cuts_.size(); ++i) {
      const ExactPolynomial p = piece(i);
      for (const Quad s : monotone_knots(p)) {
        const auto t = static_cast<double>(cuts_[i] + s * (cuts_[i + 1] - cuts_[i]));
        // The root at the start is not a crossing.
        if (ray_.starts_on_isosurface && t < 1e-12) continue;
        if (search.add(t, value(p, s), tolerance)) return search.crossing();
      }
    }
    return search.crossing();
  }

  // Returns |h - c| at a distance along the ray.
  double height(double t) const {
    std::size_t i = 0;
    while (i + 2 < cuts_.size() && t > cuts_[i + 1]) ++i;
    const Quad s = (t - cuts_[i]) / (cuts_[i + 1] - cuts_[i]);
    return static_cast<double>(magnitude(value(piece(i), s)));
  }

 private:
  // Returns the polynomial of the height along the ray from cut i to the next cut.
  ExactPolynomial piece(std::size_t i) const {
    const Quad low = cuts_[i], high = cuts_[i + 1];
    Index<D> cell;
    ExactPoint<D> from, to;
    for (int a = 0; a < D; ++a) {
      const Quad middle = position_[a] + (low + high) / 2 * direction_[a];
      cell[a] = std::clamp(static_cast<int>(middle), 0, field_.dims[a] - 2);
      from[a] = position_[a] + low * direction_[a] - cell[a];
      to[a] = position_[a] + high * direction_[a] - cell[a];
    }
    return exact_polynomial<D>(load_corners(field_, cell), ray_.isovalue, from, to);
  }

  const Field<D>& field_;
  const IsosurfaceRay<D>& ray_;
  ExactPoint<D> position_, direction_;
  std::vector<Quad> cuts_;  // ascending
};

}  // namespace leaflight::test

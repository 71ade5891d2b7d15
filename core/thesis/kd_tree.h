// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace leaflight {

struct Neighbor {
  double distance2;
  std::uint32_t number;  // of the point
};

// Nearest neighbors among points in N dimensions, by nanoflann. The result and its order depend
// only on the points and the query.
template <int N>
class KdTree {
 public:
  using Point = std::array<float, static_cast<std::size_t>(N)>;
  using Query = std::array<double, static_cast<std::size_t>(N)>;

  explicit KdTree(std::vector<Point> points);
  ~KdTree();
  KdTree(KdTree&&) noexcept;
  KdTree& operator=(KdTree&&) noexcept;

  std::size_t size() const;

  // Finds up to k points nearer than the square root of `limit2`, in no particular order.
  void nearest(const Query& query, std::size_t k, double limit2,
               std::vector<Neighbor>& found) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace leaflight

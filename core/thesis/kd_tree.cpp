// SPDX-License-Identifier: GPL-3.0-or-later
#include "thesis/kd_tree.h"

#include <algorithm>
#include <nanoflann.hpp>

namespace leaflight {
namespace {

// A heap of neighbors with the farthest on top. nanoflann's own result set inserts by shifts, which
// is slow for hundreds of neighbors.
class NearestHeap {
 public:
  using DistanceType = double;
  using IndexType = std::uint32_t;

  NearestHeap(std::size_t k, double limit2, std::vector<Neighbor>& heap)
      : k_(k), limit2_(limit2), heap_(heap) {
    heap_.clear();
  }
  std::size_t size() const { return heap_.size(); }
  bool full() const { return heap_.size() == k_; }
  void sort() {}  // nanoflann calls it from 1.6 on; the order is arbitrary
  double worstDist() const { return full() ? heap_.front().distance2 : limit2_; }
  bool addPoint(double distance2, std::uint32_t number) {
    if (!(distance2 < worstDist())) return true;
    if (full()) {
      std::pop_heap(heap_.begin(), heap_.end(), nearer);
      heap_.back() = {distance2, number};
    } else {
      heap_.push_back({distance2, number});
    }
    std::push_heap(heap_.begin(), heap_.end(), nearer);
    return true;
  }

 private:
  static bool nearer(const Neighbor& a, const Neighbor& b) {
    return a.distance2 < b.distance2 || (a.distance2 == b.distance2 && a.number < b.number);
  }

  std::size_t k_;
  double limit2_;
  std::vector<Neighbor>& heap_;
};

template <int N>
struct Cloud {
  std::vector<typename KdTree<N>::Point> points;

  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const { return points[i][axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

}  // namespace

template <int N>
struct KdTree<N>::Implementation {
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud<N>>,
                                                   Cloud<N>, N, std::uint32_t>;
  static constexpr std::size_t points_per_leaf = 16;

  explicit Implementation(std::vector<Point> points)
      : cloud{std::move(points)},
        tree(N, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(points_per_leaf)) {}

  const Cloud<N> cloud;
  const Tree tree;
};

template <int N>
KdTree<N>::KdTree(std::vector<Point> points)
    : implementation_(std::make_unique<Implementation>(std::move(points))) {}
template <int N>
KdTree<N>::~KdTree() = default;
template <int N>
KdTree<N>::KdTree(KdTree&&) noexcept = default;
template <int N>
KdTree<N>& KdTree<N>::operator=(KdTree&&) noexcept = default;

template <int N>
std::size_t KdTree<N>::size() const {
  return implementation_->cloud.points.size();
}

template <int N>
void KdTree<N>::nearest(const Query& query, std::size_t k, double limit2,
                        std::vector<Neighbor>& found) const {
  NearestHeap heap(k, limit2, found);
  if (k == 0) return;
  implementation_->tree.findNeighbors(heap, query.data(), {});
}

template class KdTree<2>;
template class KdTree<3>;
template class KdTree<4>;

}  // namespace leaflight

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace leaflight {

// Disjoint sets with path halving (Tarjan and van Leeuwen 1984). The least member names a set.
template <class Member>
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), Member{0});
  }
  Member find(Member v) {
    while (parent_[v] != v) v = parent_[v] = parent_[parent_[v]];
    return v;
  }
  void join(Member a, Member b) {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }
  // Returns the least member of the set of each member. No other function may follow.
  std::vector<Member> names() {
    // Each parent is less than its members, so it is a name already.
    for (Member& parent : parent_) parent = parent_[parent];
    return std::move(parent_);
  }

 private:
  std::vector<Member> parent_;
};

}  // namespace leaflight

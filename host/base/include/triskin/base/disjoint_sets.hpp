// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <numeric>
#include <vector>

#include "triskin/base/index.hpp"

namespace triskin {

/// Sets of the items 0 … n − 1, each with one of its items as leader. Constant cost but for reset(), nearly.
class DisjointSets {
 public:
  DisjointSets() = default;
  explicit DisjointSets(std::size_t items) { reset(items); }

  /// Every item is a set of its own. Keeps its buffer.
  void reset(std::size_t items) {
    leader_.resize(items);
    std::iota(leader_.begin(), leader_.end(), 0);
  }
  /// Leader of the set of an item.
  [[nodiscard]] int find(int item) {
    while (leader_[at(item)] != item) item = leader_[at(item)] = leader_[at(leader_[at(item)])];
    return item;
  }
  /// Joins the sets of two items; the leader is that of the second. False: they were one set already.
  bool join(int a, int b) {
    const int from = find(a), to = find(b);
    leader_[at(from)] = to;
    return from != to;
  }

 private:
  std::vector<int> leader_;
};

}  // namespace triskin

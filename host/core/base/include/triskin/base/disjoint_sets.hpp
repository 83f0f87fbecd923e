// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <numeric>
#include <vector>

#include "triskin/base/index.hpp"

namespace triskin {

/// Keeps sets of the items 0 … n − 1, each with one of its items as leader. Nearly constant cost, except for
/// reset().
class DisjointSets {
 public:
  DisjointSets() = default;
  explicit DisjointSets(std::size_t items) { reset(items); }

  /// Makes every item a set of its own. Keeps its buffer.
  void reset(std::size_t items) {
    leader_.resize(items);
    std::iota(leader_.begin(), leader_.end(), 0);
  }
  /// Returns the leader of the set of an item.
  [[nodiscard]] int find(int item) {
    while (leader_[at(item)] != item) item = leader_[at(item)] = leader_[at(leader_[at(item)])];
    return item;
  }
  /// Joins the sets of two items; the leader is that of the second. Returns false if they were already one set.
  bool join(int a, int b) {
    const int from = find(a), to = find(b);
    leader_[at(from)] = to;
    return from != to;
  }

 private:
  std::vector<int> leader_;
};

}  // namespace triskin

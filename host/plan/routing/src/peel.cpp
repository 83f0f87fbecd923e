// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "folding.hpp"
#include "partition.hpp"

namespace triskin::routing {
namespace {

constexpr int kLeft = -1;  // Unassigned nodes have this part number.

class Peeler {
 public:
  Peeler(const LocalGraph& g, int capacity, int k, long budget, Dice& random, Numbers& part_of)
      : g_(g), capacity_(capacity), k_(k), budget_(budget), random_(random), part_of_(part_of), weight_(g.node.size()) {
    part_of_.assign(g.node.size(), kLeft);
    left_ = g.size();
    for (int p = k - 1; p >= 0; --p) unused_.push_back(p);
  }

  bool run() {
    int stuck = 0;
    while (left_ > capacity_) {
      if (unused_.empty() || budget_ < 0) return false;
      bool done = false;
      for (int tries = 0; tries < 12 && !done; ++tries) done = peel_one();
      if (done) continue;
      ++stuck;
      give_back(1 + stuck % 3);
      if (stuck % 24 == 0) give_back(k_);  // This region is started afresh.
    }
    if (left_ == 0) return true;
    if (unused_.empty()) return false;
    for (int& p : part_of_) p = p == kLeft ? unused_.back() : p;
    return true;
  }

 private:
  [[nodiscard]] int some_left_node() {
    for (;;) {
      const int v = random_.below(g_.size());
      if (part_of_[v] == kLeft) return v;
      if (++misses_ % 64 == 0) return static_cast<int>(std::ranges::find(part_of_, kLeft) - part_of_.begin());
    }
  }

  bool peel_one() {
    // The remaining parts may waste this many places altogether.
    const int slack = static_cast<int>(unused_.size()) * capacity_ - left_;
    if (slack < 0) return false;
    random_tree(g_, part_of_, kLeft, some_left_node(), random_, tree_);
    budget_ -= left_;
    const int lightest = std::max(1, capacity_ - slack);
    for (const int v : tree_.order) weight_[v] = 1;
    for (auto v = tree_.order.rbegin(); v != tree_.order.rend(); ++v) {
      if (tree_.parent[*v] >= 0) weight_[tree_.parent[*v]] += weight_[*v];
    }
    candidates_.clear();
    for (const int v : tree_.order) {
      const int below = weight_[v], above = left_ - below;
      if (below >= lightest && below <= capacity_)
        candidates_.push_back(v);
      else if (above >= lightest && above <= capacity_)
        candidates_.push_back(v);
    }
    // Full parts come first, so that slack is spent only when it must be.
    for (int tries = 0; tries < 3 && !candidates_.empty(); ++tries) {
      int best = candidates_[random_.below(static_cast<int>(candidates_.size()))];
      const int other = candidates_[random_.below(static_cast<int>(candidates_.size()))];
      if (size_of(other) > size_of(best)) best = other;
      if (take(best)) return true;
    }
    return false;
  }

  [[nodiscard]] int size_of(int v) const {
    const int below = weight_[v];
    return below <= capacity_ ? below : left_ - below;
  }

  // Makes the subtree of v, or everything else, a part; undoes it if the remaining nodes then need more than k parts.
  bool take(int v) {
    const bool subtree = weight_[v] <= capacity_;
    const int part = unused_.back();
    mark_.assign(g_.node.size(), false);
    mark_[v] = true;
    for (const int u : tree_.order) {
      if (tree_.parent[u] >= 0 && mark_[tree_.parent[u]]) mark_[u] = true;
    }
    for (const int u : tree_.order) {
      if (mark_[u] == subtree) part_of_[u] = part;
    }
    budget_ -= left_;
    const int rest = left_ - size_of(v);
    if (rest > 0 && folded_lower_bound(g_, part_of_, kLeft, capacity_) > static_cast<int>(unused_.size()) - 1) {
      for (const int u : tree_.order) part_of_[u] = kLeft;
      return false;
    }
    unused_.pop_back();
    left_ = rest;
    return true;
  }

  // Gives `count` parts that touch the remaining nodes back to them.
  void give_back(int count) {
    for (int k = 0; k < count; ++k) {
      candidates_.clear();
      for (int v = 0; v < g_.size(); ++v) {
        if (part_of_[v] != kLeft) continue;
        for (const int w : g_.neighbour[v]) {
          if (w >= 0 && part_of_[w] != kLeft) candidates_.push_back(part_of_[w]);
        }
      }
      budget_ -= g_.size();
      if (candidates_.empty()) return;
      const int part = candidates_[random_.below(static_cast<int>(candidates_.size()))];
      for (int& p : part_of_) {
        if (p != part) continue;
        p = kLeft;
        ++left_;
      }
      unused_.push_back(part);
    }
  }

  const LocalGraph& g_;
  int capacity_, k_;
  long budget_;
  Dice& random_;
  Numbers& part_of_;
  Numbers unused_, weight_, candidates_;
  Table<int, bool> mark_;
  SpanningTree tree_;
  int left_ = 0;
  unsigned misses_ = 0;
};

}  // namespace

bool peel(const LocalGraph& g, int capacity, int k, long budget, Dice& random, Numbers& part_of) {
  return Peeler(g, capacity, k, budget, random, part_of).run();
}

}  // namespace triskin::routing

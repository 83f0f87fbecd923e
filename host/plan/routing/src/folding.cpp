// SPDX-License-Identifier: GPL-3.0-or-later
#include "folding.hpp"

#include <algorithm>

namespace triskin::routing {
namespace {

// Peels leaves until only the core remains; `settle` visits every folded node before its attachment, core nodes last.
class Folder {
 public:
  Folder(const LocalGraph& g, const Numbers& part_of, int part, int capacity)
      : g_(g),
        part_of_(part_of),
        part_(part),
        capacity_(capacity),
        degree_(g.node.size(), 0),
        kept_(g.node.size(), {-1, -1, -1}),
        weight_(g.node.size(), 0) {}

  void run() {
    Numbers leaves;
    for (int v = 0; v < g_.size(); ++v) {
      if (part_of_[v] != part_) continue;
      ++left_;
      for (const int w : g_.neighbour[v]) degree_[v] += inside(w) ? 1 : 0;
      if (degree_[v] <= 1) leaves.push_back(v);
    }
    gone_.assign(g_.node.size(), false);
    while (!leaves.empty() && left_ > 1) {
      const int v = leaves.back();
      leaves.pop_back();
      if (gone_[v]) continue;
      settle(v);
      gone_[v] = true;
      --left_;
      for (const int w : g_.neighbour[v]) {
        if (!inside(w) || gone_[w]) continue;
        kept_[w][count(w)] = v;
        if (--degree_[w] == 1) leaves.push_back(w);
      }
    }
    for (int v = 0; v < g_.size(); ++v) {
      if (part_of_[v] != part_ || gone_[v]) continue;
      settle(v);
      core_.push_back(v);
      rest_ += weight_[v];
    }
  }

  [[nodiscard]] int bound() const { return static_cast<int>(closed_.size()) + (rest_ + capacity_ - 1) / capacity_; }

  [[nodiscard]] Folding expand() const {
    Folding f;
    f.core = core_;
    f.branch_weight.assign(g_.node.size(), 0);
    f.branch.resize(g_.node.size());
    for (const int v : core_) {
      f.branch_weight[v] = weight_[v] - 1;
      collect(v, f.branch[v]);
      f.branch[v].erase(f.branch[v].begin());
    }
    for (const int v : closed_) {
      f.closed.emplace_back();
      collect(v, f.closed.back());
    }
    return f;
  }

 private:
  [[nodiscard]] bool inside(int v) const { return v >= 0 && part_of_[v] == part_; }
  [[nodiscard]] int count(int v) const {
    return static_cast<int>(std::ranges::count_if(kept_[v], [](int c) { return c >= 0; }));
  }

  void settle(int v) {
    auto& mine = kept_[v];
    const int n = count(v);
    std::sort(mine.begin(), mine.begin() + n,
              [&](int a, int b) { return std::pair(weight_[a], a) < std::pair(weight_[b], b); });
    int sum = 1;
    for (int k = 0; k < n; ++k) sum += weight_[mine[k]];
    for (int k = n - 1; sum > capacity_; --k) {
      sum -= weight_[mine[k]];
      closed_.push_back(mine[k]);
      mine[k] = -1;
    }
    weight_[v] = sum;
  }

  void collect(int v, Numbers& into) const {
    const std::size_t first = into.size();
    into.push_back(v);
    for (std::size_t k = first; k < into.size(); ++k) {
      for (const int c : kept_[into[k]]) {
        if (c >= 0) into.push_back(c);
      }
    }
  }

  const LocalGraph& g_;
  const Numbers& part_of_;
  int part_, capacity_;
  Numbers degree_;
  Table<int, Triple<int>> kept_;  // Branches are sorted, the lightest first; −1 marks a closed one.
  Numbers weight_;
  Table<int, bool> gone_;
  Numbers closed_, core_;
  int left_ = 0, rest_ = 0;
};

}  // namespace

Folding fold(const LocalGraph& g, const Numbers& part_of, int part, int capacity) {
  Folder folder(g, part_of, part, capacity);
  folder.run();
  return folder.expand();
}

int folded_lower_bound(const LocalGraph& g, const Numbers& part_of, int part, int capacity) {
  Folder folder(g, part_of, part, capacity);
  folder.run();
  return folder.bound();
}

}  // namespace triskin::routing

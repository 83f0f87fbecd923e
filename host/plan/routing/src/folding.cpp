// SPDX-License-Identifier: GPL-3.0-or-later
#include "folding.hpp"

#include <algorithm>

namespace triskin::routing {
namespace {

// Peels leaves until only the core remains; `settle` visits every folded node before its attachment, core nodes last.
class Folder {
 public:
  Folder(const LocalGraph& g, const std::vector<int>& part_of, int part, int capacity)
      : g_(g),
        part_of_(part_of),
        part_(part),
        capacity_(capacity),
        degree_(at(g.size()), 0),
        kept_(at(g.size()), {-1, -1, -1}),
        weight_(at(g.size()), 0) {}

  void run() {
    std::vector<int> leaves;
    for (int v = 0; v < g_.size(); ++v) {
      if (part_of_[at(v)] != part_) continue;
      ++left_;
      for (const int w : g_.neighbour[at(v)]) degree_[at(v)] += inside(w) ? 1 : 0;
      if (degree_[at(v)] <= 1) leaves.push_back(v);
    }
    gone_.assign(at(g_.size()), false);
    while (!leaves.empty() && left_ > 1) {
      const int v = leaves.back();
      leaves.pop_back();
      if (gone_[at(v)]) continue;
      settle(v);
      gone_[at(v)] = true;
      --left_;
      for (const int w : g_.neighbour[at(v)]) {
        if (!inside(w) || gone_[at(w)]) continue;
        kept_[at(w)][at(count(w))] = v;
        if (--degree_[at(w)] == 1) leaves.push_back(w);
      }
    }
    for (int v = 0; v < g_.size(); ++v) {
      if (part_of_[at(v)] != part_ || gone_[at(v)]) continue;
      settle(v);
      core_.push_back(v);
      rest_ += weight_[at(v)];
    }
  }

  [[nodiscard]] int bound() const { return static_cast<int>(closed_.size()) + (rest_ + capacity_ - 1) / capacity_; }

  [[nodiscard]] Folding expand() const {
    Folding f;
    f.core = core_;
    f.branch_weight.assign(at(g_.size()), 0);
    f.branch.resize(at(g_.size()));
    for (const int v : core_) {
      f.branch_weight[at(v)] = weight_[at(v)] - 1;
      collect(v, f.branch[at(v)]);
      f.branch[at(v)].erase(f.branch[at(v)].begin());
    }
    for (const int v : closed_) {
      f.closed.emplace_back();
      collect(v, f.closed.back());
    }
    return f;
  }

 private:
  [[nodiscard]] bool inside(int v) const { return v >= 0 && part_of_[at(v)] == part_; }
  [[nodiscard]] int count(int v) const {
    return static_cast<int>(std::ranges::count_if(kept_[at(v)], [](int c) { return c >= 0; }));
  }

  void settle(int v) {
    auto& mine = kept_[at(v)];
    const int n = count(v);
    std::sort(mine.begin(), mine.begin() + n,
              [&](int a, int b) { return std::pair(weight_[at(a)], a) < std::pair(weight_[at(b)], b); });
    int sum = 1;
    for (int k = 0; k < n; ++k) sum += weight_[at(mine[at(k)])];
    for (int k = n - 1; sum > capacity_; --k) {
      sum -= weight_[at(mine[at(k)])];
      closed_.push_back(mine[at(k)]);
      mine[at(k)] = -1;
    }
    weight_[at(v)] = sum;
  }

  void collect(int v, std::vector<int>& into) const {
    const std::size_t first = into.size();
    into.push_back(v);
    for (std::size_t k = first; k < into.size(); ++k) {
      for (const int c : kept_[at(into[k])]) {
        if (c >= 0) into.push_back(c);
      }
    }
  }

  const LocalGraph& g_;
  const std::vector<int>& part_of_;
  int part_, capacity_;
  std::vector<int> degree_;
  std::vector<std::array<int, 3>> kept_;  // Branches are sorted, the lightest first; −1 marks a closed one.
  std::vector<int> weight_;
  std::vector<bool> gone_;
  std::vector<int> closed_, core_;
  int left_ = 0, rest_ = 0;
};

}  // namespace

Folding fold(const LocalGraph& g, const std::vector<int>& part_of, int part, int capacity) {
  Folder folder(g, part_of, part, capacity);
  folder.run();
  return folder.expand();
}

int folded_lower_bound(const LocalGraph& g, const std::vector<int>& part_of, int part, int capacity) {
  Folder folder(g, part_of, part, capacity);
  folder.run();
  return folder.bound();
}

}  // namespace triskin::routing

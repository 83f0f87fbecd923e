// SPDX-License-Identifier: GPL-3.0-or-later
#include "spanning_trees.hpp"

#include <numeric>

#include "triskin/base/disjoint_sets.hpp"

namespace triskin::routing {
namespace {

// Decides joint by joint: a joint is added to the tree unless it closes a cycle, and left out unless the rest falls
// apart.
class Enumerator {
 public:
  Enumerator(const LocalGraph& g, const std::function<void(const std::vector<Joint>&)>& visit)
      : n_(g.size()), joints_(joints_of(g)), visit_(visit), out_(joints_.size(), false) {}

  void run() {
    Numbers block(at(n_));
    std::iota(block.begin(), block.end(), 0);
    decide(0, block);
  }

 private:
  void decide(std::size_t k, const Numbers& block) {
    if (static_cast<int>(tree_.size()) == n_ - 1) return visit_(tree_);
    if (k == joints_.size()) return;
    const Joint j = joints_[k];
    const bool closes_cycle = block[j.a] == block[j.b];
    if (!closes_cycle) {
      Numbers joined = block;
      for (int& b : joined) b = b == block[j.b] ? block[j.a] : b;
      tree_.push_back(j);
      decide(k + 1, joined);
      tree_.pop_back();
    }
    out_[k] = true;
    if (closes_cycle || still_connected()) decide(k + 1, block);
    out_[k] = false;
  }

  [[nodiscard]] bool still_connected() const {
    DisjointSets sets(at(n_));
    int blocks = n_;
    for (std::size_t k = 0; k < joints_.size(); ++k) {
      if (!out_[k] && sets.join(joints_[k].a, joints_[k].b)) --blocks;
    }
    return blocks == 1;
  }

  int n_;
  std::vector<Joint> joints_;
  const std::function<void(const std::vector<Joint>&)>& visit_;
  std::vector<bool> out_;
  std::vector<Joint> tree_;
};

}  // namespace

std::vector<Joint> joints_of(const LocalGraph& g) {
  std::vector<Joint> joints;
  for (int v = 0; v < g.size(); ++v) {
    for (const int w : g.neighbour[v]) {
      if (w > v) joints.push_back({v, w});
    }
  }
  return joints;
}

void for_each_spanning_tree(const LocalGraph& g, const std::function<void(const std::vector<Joint>&)>& visit) {
  Enumerator(g, visit).run();
}

}  // namespace triskin::routing

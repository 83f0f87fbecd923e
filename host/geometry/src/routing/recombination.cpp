// SPDX-License-Identifier: GPL-3.0-or-later
#include "recombination.hpp"

#include <algorithm>

#include "part_bits.hpp"
#include "wiring.hpp"

namespace triskin::geometry {
namespace {

constexpr int kNoBorder = 20'000, kParted = 24, kDepth = 4;
constexpr int kFirstThreshold = 60;

// Modules that are cut off the largest rest by each single module failure.
int parted(const PartBits& bits) {
  int sum = 0;
  for (int v = 0; v < bits.n; ++v) {
    std::uint32_t rest = bits.all & ~(1U << v);
    const int left = std::popcount(rest);
    int largest = 0;
    while (rest != 0) {
      const std::uint32_t piece = bits.reach(rest & (~rest + 1), rest);
      largest = std::max(largest, std::popcount(piece));
      rest &= ~piece;
    }
    sum += left - largest;
  }
  return sum;
}

class Recombiner {
 public:
  Recombiner(const ModuleGraph& graph, const LocalGraph& g, const RoutingOptions& options, Random& random, Partition& partition)
      : graph_(graph), g_(g), options_(options), random_(random), p_(partition), members_(at(partition.parts)), cost_(at(partition.parts)) {
    for (int v = 0; v < g.size(); ++v) members_[at(p_.part_of[at(v)])].push_back(v);
    for (std::size_t k = 0; k < members_.size(); ++k) cost_[k] = cost_of(members_[k]);
  }

  void run(int moves) {
    for (int k = 0; k < moves; ++k) {
      // The second half only descends: the end is a local optimum of what was visited.
      move(std::max(0, kFirstThreshold - 2 * kFirstThreshold * k / moves));
    }
  }

 private:
  [[nodiscard]] int cost_of(const std::vector<int>& nodes) const {
    std::vector<int> global;
    global.reserve(nodes.size());
    for (const int v : nodes) global.push_back(g_.node[at(v)]);
    return secondary_cost(graph_, localize(graph_, std::move(global)), options_);
  }

  void move(int threshold) {
    const int v = random_.below(g_.size());
    const int w = g_.neighbour[at(v)][at(random_.below(3))];
    if (w < 0 || p_.part_of[at(w)] == p_.part_of[at(v)]) return;
    const int a = p_.part_of[at(v)], b = p_.part_of[at(w)];
    split(a, b);
    if (left_.empty()) return;
    const int cost_a = cost_of(left_), cost_b = cost_of(right_);
    if (cost_a + cost_b > cost_[at(a)] + cost_[at(b)] + threshold) return;
    members_[at(a)] = left_;
    members_[at(b)] = right_;
    cost_[at(a)] = cost_a;
    cost_[at(b)] = cost_b;
    for (const int u : left_) p_.part_of[at(u)] = a;
    for (const int u : right_) p_.part_of[at(u)] = b;
  }

  // A random cut of a random tree of both parts into left_ and right_; left_ is empty when no cut fits.
  void split(int a, int b) {
    std::vector<int> nodes = members_[at(a)];
    nodes.insert(nodes.end(), members_[at(b)].begin(), members_[at(b)].end());
    std::ranges::sort(nodes);
    LocalGraph both{nodes, {}};
    for (const int v : nodes) {
      std::array<int, 3> n{-1, -1, -1};
      for (std::size_t s = 0; s < 3; ++s) {
        const int w = g_.neighbour[at(v)][s];
        if (w < 0 || (p_.part_of[at(w)] != a && p_.part_of[at(w)] != b)) continue;
        n[s] = static_cast<int>(std::ranges::lower_bound(nodes, w) - nodes.begin());
      }
      both.neighbour.push_back(n);
    }
    left_.clear();
    right_.clear();
    const std::vector<int> whole(nodes.size(), 0);
    for (int tries = 0; tries < 3 && left_.empty(); ++tries) {
      random_tree(both, whole, 0, random_.below(both.size()), random_, tree_);
      cut(both);
    }
  }

  void cut(const LocalGraph& both) {
    std::vector<int> size(at(both.size()), 1), fits;
    for (auto v = tree_.order.rbegin(); v != tree_.order.rend(); ++v) {
      const int p = tree_.parent[at(*v)];
      if (p < 0) continue;
      if (size[at(*v)] <= options_.capacity && both.size() - size[at(*v)] <= options_.capacity) fits.push_back(*v);
      size[at(p)] += size[at(*v)];
    }
    if (fits.empty()) return;
    const int top = fits[at(random_.below(static_cast<int>(fits.size())))];
    std::vector<bool> below(at(both.size()), false);
    for (const int v : tree_.order) {
      below[at(v)] = v == top || (tree_.parent[at(v)] >= 0 && below[at(tree_.parent[at(v)])]);
      (below[at(v)] ? left_ : right_).push_back(both.node[at(v)]);
    }
  }

  const ModuleGraph& graph_;
  const LocalGraph& g_;
  const RoutingOptions& options_;
  Random& random_;
  Partition& p_;
  std::vector<std::vector<int>> members_;
  std::vector<int> cost_, left_, right_;
  SpanningTree tree_;
};

}  // namespace

int secondary_cost(const ModuleGraph& graph, const LocalGraph& part, const RoutingOptions& options) {
  const PartBits bits(part);
  int best = -1;
  bool on_border = false;
  for (int v = 0; v < part.size(); ++v) {
    bool border = false;
    for (int s = 0; s < 3; ++s) border = border || is_border(graph, part.node[at(v)], s);
    if (on_border && !border) continue;
    int entry = kDepth * bits.sum_of_distances(v);
    if (options.has_controller_place) entry += static_cast<int>(cable_m(graph, part.node[at(v)], options) * 100.0);
    if (best < 0 || entry < best || (border && !on_border)) best = entry;
    on_border = on_border || border;
  }
  return (on_border ? 0 : kNoBorder) + kParted * parted(bits) + best;
}

void recombine(const ModuleGraph& graph, const LocalGraph& g, const RoutingOptions& options, int moves, Random& random, Partition& partition) {
  if (partition.parts < 2) return;
  Recombiner(graph, g, options, random, partition).run(moves);
}

}  // namespace triskin::geometry

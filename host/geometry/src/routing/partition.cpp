// SPDX-License-Identifier: GPL-3.0-or-later
#include "partition.hpp"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <random>

namespace triskin::geometry {
namespace {

std::size_t at(int k) { return static_cast<std::size_t>(k); }

// A spanning tree of the component as an order (parents first) and parents, by randomized search from a random root:
// mixing breadth and depth first gives bushy and stringy trees.
struct Tree {
  std::vector<int> order;
  std::vector<int> parent;  // by node
};

class TreeCutter {
 public:
  TreeCutter(const ModuleGraph& graph, const std::vector<int>& component, int capacity, std::uint64_t seed)
      : graph_(graph), component_(component), capacity_(capacity), random_(seed), seen_(graph.nodes.size(), -1) {}

  std::vector<std::vector<int>> attempt() {
    const Tree tree = random_tree();
    return cut(tree);
  }

 private:
  std::uint64_t below(std::uint64_t n) { return random_() % n; }

  Tree random_tree() {
    ++stamp_;
    Tree tree;
    tree.parent.assign(graph_.nodes.size(), -1);
    std::vector<int> front{component_[below(component_.size())]};
    seen_[at(front[0])] = stamp_;
    const std::uint64_t style = below(3);
    while (!front.empty()) {
      const std::size_t pick = style == 0 ? 0 : style == 1 ? front.size() - 1 : below(front.size());
      const int v = front[pick];
      front.erase(front.begin() + static_cast<std::ptrdiff_t>(pick));
      tree.order.push_back(v);
      std::array<int, 3> sides{0, 1, 2};
      std::ranges::shuffle(sides, random_);
      for (const int s : sides) {
        const int w = graph_.nodes[at(v)].neighbour[at(s)];
        if (w < 0 || seen_[at(w)] == stamp_) continue;
        seen_[at(w)] = stamp_;
        tree.parent[at(w)] = v;
        front.push_back(w);
      }
    }
    return tree;
  }

  // Bottom-up: where a subtree outgrows the capacity, its heaviest child becomes a part of its own. Fewest parts for
  // this tree (Kundu and Misra, 1977).
  std::vector<std::vector<int>> cut(const Tree& tree) {
    std::vector<int> weight(graph_.nodes.size(), 1);
    std::vector<std::vector<int>> children(graph_.nodes.size());
    std::vector<bool> is_root(graph_.nodes.size(), false);
    for (auto v = tree.order.rbegin(); v != tree.order.rend(); ++v) {
      auto& mine = children[at(*v)];
      std::ranges::sort(mine, {}, [&](int c) { return std::pair(weight[at(c)], c); });
      for (const int c : mine) weight[at(*v)] += weight[at(c)];
      while (weight[at(*v)] > capacity_) {
        weight[at(*v)] -= weight[at(mine.back())];
        is_root[at(mine.back())] = true;
        mine.pop_back();
      }
      const int p = tree.parent[at(*v)];
      if (p >= 0) children[at(p)].push_back(*v);
      else is_root[at(*v)] = true;
    }
    std::vector<int> part_of(graph_.nodes.size(), -1);
    std::vector<std::vector<int>> parts;
    for (const int v : tree.order) {
      if (is_root[at(v)]) {
        part_of[at(v)] = static_cast<int>(parts.size());
        parts.emplace_back();
      } else {
        part_of[at(v)] = part_of[at(tree.parent[at(v)])];
      }
      parts[at(part_of[at(v)])].push_back(v);
    }
    return parts;
  }

  const ModuleGraph& graph_;
  const std::vector<int>& component_;
  int capacity_;
  std::mt19937_64 random_;
  std::vector<std::int64_t> seen_;
  std::int64_t stamp_ = 0;
};

}  // namespace

std::vector<std::vector<int>> components(const ModuleGraph& graph) {
  std::vector<std::vector<int>> result;
  std::vector<bool> seen(graph.nodes.size(), false);
  for (std::size_t start = 0; start < graph.nodes.size(); ++start) {
    if (seen[start]) continue;
    std::vector<int> component{static_cast<int>(start)};
    seen[start] = true;
    for (std::size_t k = 0; k < component.size(); ++k) {
      for (const int w : graph.nodes[at(component[k])].neighbour) {
        if (w < 0 || seen[at(w)]) continue;
        seen[at(w)] = true;
        component.push_back(w);
      }
    }
    std::ranges::sort(component);
    result.push_back(std::move(component));
  }
  return result;
}

int folded_lower_bound(const ModuleGraph& graph, const std::vector<int>& component, int capacity) {
  // Fold pendant trees into their attachment. A node with more pendant weight than fits beside it has to leave whole
  // branches to other parts; in a tree the bottom-up cut is exact, so cutting the heaviest branch first loses nothing.
  std::vector<int> degree(graph.nodes.size(), 0), weight(graph.nodes.size(), 1);
  std::vector<std::vector<int>> branches(graph.nodes.size());
  std::vector<int> leaves;
  for (const int v : component) {
    for (const int w : graph.nodes[at(v)].neighbour) degree[at(v)] += w >= 0 ? 1 : 0;
    if (degree[at(v)] <= 1) leaves.push_back(v);
  }
  std::vector<bool> gone(graph.nodes.size(), false);
  int closed = 0;
  const auto settle = [&](int v) {
    auto& b = branches[at(v)];
    std::ranges::sort(b);
    int sum = 1 + std::accumulate(b.begin(), b.end(), 0);
    while (sum > capacity) {
      sum -= b.back();
      b.pop_back();
      ++closed;
    }
    weight[at(v)] = sum;
  };
  std::size_t left = component.size();
  while (!leaves.empty()) {
    const int v = leaves.back();
    leaves.pop_back();
    if (gone[at(v)]) continue;
    settle(v);
    if (left == 1) break;
    gone[at(v)] = true;
    --left;
    for (const int w : graph.nodes[at(v)].neighbour) {
      if (w < 0 || gone[at(w)]) continue;
      branches[at(w)].push_back(weight[at(v)]);
      if (--degree[at(w)] == 1) leaves.push_back(w);
    }
  }
  int rest = 0;
  for (const int v : component) {
    if (gone[at(v)]) continue;
    settle(v);
    rest += weight[at(v)];
  }
  const int n = static_cast<int>(component.size());
  return std::max((n + capacity - 1) / capacity, closed + (rest + capacity - 1) / capacity);
}

Partition partition(const ModuleGraph& graph, const std::vector<int>& component, int capacity, std::uint64_t seed, double time_limit_s) {
  Partition best;
  best.lower_bound = folded_lower_bound(graph, component, capacity);
  TreeCutter cutter(graph, component, capacity, seed);
  const auto start = std::chrono::steady_clock::now();
  constexpr int kAttempts = 4000;  // counted, so that the result does not depend on the machine
  for (int k = 0; k < kAttempts; ++k) {
    auto parts = cutter.attempt();
    if (best.parts.empty() || parts.size() < best.parts.size()) best.parts = std::move(parts);
    if (static_cast<int>(best.parts.size()) == best.lower_bound) break;
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (seconds > time_limit_s) break;
  }
  for (auto& part : best.parts) std::ranges::sort(part);
  std::ranges::sort(best.parts);
  return best;
}

}  // namespace triskin::geometry

// SPDX-License-Identifier: GPL-3.0-or-later
#include "local_graph.hpp"

#include <algorithm>

namespace triskin::routing {
namespace {

// `neighbours_of(node)` returns those over its three sides, −1 for none.
Table<int, Numbers> components(std::size_t nodes, const auto& neighbours_of) {
  Table<int, Numbers> result;
  Table<int, bool> seen(nodes, false);
  for (std::size_t start = 0; start < nodes; ++start) {
    if (seen[start]) continue;
    Numbers component{static_cast<int>(start)};
    seen[start] = true;
    for (std::size_t k = 0; k < component.size(); ++k) {
      for (const int w : neighbours_of(component[k])) {
        if (w < 0 || seen[w]) continue;
        seen[w] = true;
        component.push_back(w);
      }
    }
    std::ranges::sort(component);
    result.push_back(std::move(component));
  }
  return result;
}

}  // namespace

LocalGraph localize(const ModuleGraph& graph, Numbers nodes) {
  std::ranges::sort(nodes);
  LocalGraph g{std::move(nodes), {}};
  g.neighbour.reserve(g.node.size());
  for (const int v : g.node) {
    std::array<int, 3> n{-1, -1, -1};
    for (std::size_t s = 0; s < 3; ++s) {
      const auto found = std::ranges::lower_bound(g.node, graph.nodes[at(v)].neighbour[s]);
      if (found != g.node.end() && *found == graph.nodes[at(v)].neighbour[s])
        n[s] = static_cast<int>(found - g.node.begin());
    }
    g.neighbour.push_back(n);
  }
  return g;
}

Table<int, Numbers> components(const ModuleGraph& graph) {
  return components(graph.nodes.size(), [&](int v) { return graph.nodes[at(v)].neighbour; });
}

Table<int, Numbers> components(const LocalGraph& graph) {
  return components(graph.neighbour.size(), [&](int v) { return graph.neighbour[v]; });
}

void random_tree(const LocalGraph& g, const Numbers& part_of, int part, int root, Dice& random, SpanningTree& tree) {
  constexpr int kUnseen = -2;
  tree.order.clear();
  tree.parent.assign(g.node.size(), kUnseen);
  // A stack of joints (from, to): popping the top goes deep, popping elsewhere spreads.
  Table<int, std::array<int, 2>> front{{-1, root}};
  const int depth_first_of_8 = random.below(9);
  while (!front.empty()) {
    if (random.below(8) >= depth_first_of_8)
      std::swap(front[random.below(static_cast<int>(front.size()))], front.back());
    const auto [from, v] = front.back();
    front.pop_back();
    if (tree.parent[v] != kUnseen) continue;
    tree.parent[v] = from;
    tree.order.push_back(v);
    const int first = random.below(3);
    for (int k = 0; k < 3; ++k) {
      const int w = g.neighbour[v][(first + k) % 3];
      if (w >= 0 && part_of[w] == part && tree.parent[w] == kUnseen) front.push_back({v, w});
    }
  }
}

}  // namespace triskin::routing

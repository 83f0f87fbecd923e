// SPDX-License-Identifier: GPL-3.0-or-later
#include "wiring.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>

#include "line_assignment.hpp"

namespace triskin::geometry {
namespace {

std::size_t at(int k) { return static_cast<std::size_t>(k); }

// The part with local numbers 0 … n−1.
struct LocalGraph {
  std::vector<int> node;
  std::vector<std::array<int, 3>> neighbour;  // by side, local, −1 outside the part
};

LocalGraph localize(const ModuleGraph& graph, const std::vector<int>& part) {
  LocalGraph g{part, {}};
  std::map<int, int> local;
  for (std::size_t k = 0; k < part.size(); ++k) local[part[k]] = static_cast<int>(k);
  for (const int v : part) {
    std::array<int, 3> n{-1, -1, -1};
    for (std::size_t s = 0; s < 3; ++s) {
      const auto found = local.find(graph.nodes[at(v)].neighbour[s]);
      if (found != local.end()) n[s] = found->second;
    }
    g.neighbour.push_back(n);
  }
  return g;
}

struct Tree {
  std::vector<int> order;   // parents first; order[0] is the entry
  std::vector<int> parent;  // local, −1 at the entry
  std::vector<int> depth;
  int sum_of_depths = 0;
};

// Breadth-first tree from `root` without the root's side `blocked` (−1: none); of several parents on the level above the
// one with fewest children so far, which spreads the lines. Empty when something stays out of reach.
std::optional<Tree> breadth_first(const LocalGraph& g, int root, int blocked) {
  const std::size_t n = g.node.size();
  Tree t{{root}, std::vector<int>(n, -1), std::vector<int>(n, -1), 0};
  t.depth[at(root)] = 0;
  for (std::size_t k = 0; k < t.order.size(); ++k) {
    const int v = t.order[k];
    for (int s = 0; s < 3; ++s) {
      const int w = g.neighbour[at(v)][at(s)];
      if (w < 0 || t.depth[at(w)] >= 0 || (v == root && s == blocked)) continue;
      if (w != root) {
        t.depth[at(w)] = t.depth[at(v)] + 1;
        t.parent[at(w)] = v;
        t.sum_of_depths += t.depth[at(w)];
        t.order.push_back(w);
      }
    }
  }
  if (t.order.size() != n) return std::nullopt;
  return t;
}

struct Entry {
  int root = -1;
  int blocked = -1;  // side of the root that carries no tree edge, where the cable enters
  bool border = false;
};

// Sides at which a cable can enter: free ones first; at a joined side the joint is cut.
std::vector<Entry> entries(const ModuleGraph& graph, const LocalGraph& g) {
  std::vector<Entry> result;
  for (std::size_t v = 0; v < g.node.size(); ++v) {
    const ModuleGraph::Node& node = graph.nodes[at(g.node[v])];
    for (int s = 0; s < 3; ++s) {
      const bool border = node.neighbour[at(s)] < 0 && node.border[at(s)];
      result.push_back({static_cast<int>(v), s, border});
    }
  }
  return result;
}

Patch assemble(const ModuleGraph& graph, const LocalGraph& g, const Tree& t, int entry_side, const RoutingOptions& options) {
  std::vector<int> rank(g.node.size());
  for (std::size_t k = 0; k < t.order.size(); ++k) rank[at(t.order[k])] = static_cast<int>(k);
  std::vector<int> parent;
  for (const int v : t.order) parent.push_back(t.parent[at(v)] < 0 ? -1 : rank[at(t.parent[at(v)])]);
  const LineAssignment lines = assign_lines(parent, options.lines, options.addresses);
  Patch patch;
  patch.entry = g.node[at(t.order[0])];
  patch.line_hops = lines.line_hops;
  std::vector<int> next_address(at(options.lines), 0);
  for (std::size_t k = 0; k < t.order.size(); ++k) {
    const int v = t.order[k], p = t.parent[at(v)];
    RoutedModule m;
    m.node = g.node[at(v)];
    m.parent = p < 0 ? -1 : g.node[at(p)];
    m.depth = t.depth[at(v)];
    m.line = lines.line[k];
    m.address = next_address[at(m.line)]++;
    m.rotation = entry_side;
    for (int s = 0; s < 3 && p >= 0; ++s) {
      if (graph.nodes[at(m.node)].neighbour[at(s)] == m.parent) m.rotation = s;
    }
    patch.max_depth = std::max(patch.max_depth, m.depth);
    patch.modules.push_back(m);
  }
  for (std::size_t v = 0; v < g.node.size(); ++v) {
    for (const int w : g.neighbour[v]) {
      if (w < static_cast<int>(v) || t.parent[v] == w || t.parent[at(w)] == static_cast<int>(v)) continue;
      patch.cut_joints.push_back({g.node[v], g.node[at(w)]});
    }
  }
  return patch;
}

// Modules of the patch that the entry still reaches over the joints that are left.
std::vector<int> reachable(const LocalGraph& g, int root, int dead, std::array<int, 2> broken, std::vector<int>& parent) {
  parent.assign(g.node.size(), -1);
  std::vector<int> order;
  if (root == dead) return order;
  std::vector<bool> seen(g.node.size(), false);
  seen[at(root)] = true;
  order.push_back(root);
  for (std::size_t k = 0; k < order.size(); ++k) {
    const int v = order[k];
    for (const int w : g.neighbour[at(v)]) {
      const bool cut = (v == broken[0] && w == broken[1]) || (v == broken[1] && w == broken[0]);
      if (w < 0 || w == dead || cut || seen[at(w)]) continue;
      seen[at(w)] = true;
      parent[at(w)] = v;
      order.push_back(w);
    }
  }
  return order;
}

}  // namespace

Patch wire(const ModuleGraph& graph, const std::vector<int>& part, const RoutingOptions& options) {
  const LocalGraph g = localize(graph, part);
  std::optional<Patch> best;
  // Border entries come before all others, then least loss, hops, depth.
  std::array<int, 4> best_key{};
  for (const Entry& e : entries(graph, g)) {
    const std::optional<Tree> tree = breadth_first(g, e.root, e.blocked);
    if (!tree) continue;
    if (best && std::pair(e.border ? 0 : 1, tree->sum_of_depths) > std::pair(best_key[0], best_key[1])) continue;
    Patch patch = assemble(graph, g, *tree, e.blocked, options);
    const std::array key{e.border ? 0 : 1, tree->sum_of_depths, patch.line_hops, patch.max_depth};
    if (!best || key < best_key) {
      best = std::move(patch);
      best_key = key;
    }
  }
  return std::move(best).value();  // a leaf of any spanning tree is an entry: there is always one
}

void analyse_failures(const ModuleGraph& graph, Patch& patch) {
  std::vector<int> part;
  for (const RoutedModule& m : patch.modules) part.push_back(m.node);
  const LocalGraph g = localize(graph, part);
  std::map<int, int> local;
  for (std::size_t k = 0; k < part.size(); ++k) local[part[k]] = static_cast<int>(k);
  const int n = static_cast<int>(part.size());
  std::vector<int> subtree(part.size(), 1), tree_parent(part.size(), -1);
  for (std::size_t k = part.size(); k-- > 1;) {
    tree_parent[k] = local.at(patch.modules[k].parent);
    subtree[at(tree_parent[k])] += subtree[k];
  }
  patch.failures.clear();
  const auto add = [&](int dead, std::array<int, 2> broken, int strapped) {
    FailureLoss f;
    f.node = part[at(dead >= 0 ? dead : broken[1])];
    f.other_node = dead >= 0 ? -1 : part[at(broken[0])];
    f.lost_strapped = strapped;
    std::vector<int> parent;
    const std::vector<int> alive = reachable(g, 0, dead, broken, parent);
    f.lost_rerouted = n - static_cast<int>(alive.size());
    for (const int v : alive) {
      if (v != 0 && parent[at(v)] != tree_parent[at(v)]) f.backup_tree.push_back({part[at(v)], part[at(parent[at(v)])]});
    }
    patch.failures.push_back(std::move(f));
  };
  for (int v = 0; v < n; ++v) add(v, {-1, -1}, subtree[at(v)]);
  for (int v = 1; v < n; ++v) add(-1, {tree_parent[at(v)], v}, subtree[at(v)]);
}

}  // namespace triskin::geometry

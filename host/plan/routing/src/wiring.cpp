// SPDX-License-Identifier: GPL-3.0-or-later
#include "wiring.hpp"

#include <algorithm>
#include <cmath>

#include "electrical.hpp"
#include "spanning_trees.hpp"

namespace triskin::routing {
namespace {

using Key = std::array<int, 5>;

struct RootedTree {
  Numbers order;   // Local nodes are listed with parents first.
  Numbers parent;  // Parents are positions in `order`.
  Numbers depth;   // The index is a position in `order`.
  int sum_of_depths = 0;
  int max_depth = 0;
};

class Wirer {
 public:
  Wirer(const ModuleGraph& graph, const Numbers& part, const RoutingOptions& options, LineAssigner& lines,
        const std::vector<Jumper>& jumpers)
      : graph_(graph), g_(localize(graph, part)), options_(options), lines_(lines), tree_(g_.node.size()) {
    std::ranges::copy_if(jumpers, std::back_inserter(jumpers_),
                         [&](const Jumper& j) { return std::ranges::binary_search(g_.node, j.node[0]); });
    for (int v = 0; v < g_.size(); ++v) {
      for (int s = 0; s < 3; ++s) has_border_ = has_border_ || is_border(graph_, g_.node[v], s);
    }
  }

  Patch run() {
    for_each_spanning_tree(g_, [&](const std::vector<Joint>& joints) {
      load(joints);
      for (int root = 0; root < g_.size(); ++root) try_root(root);
    });
    return assemble();
  }

 private:
  void load(const std::vector<Joint>& joints) {
    for (auto& n : tree_) n.clear();
    for (const Joint& j : joints) {
      tree_[j.a].push_back(j.b);
      tree_[j.b].push_back(j.a);
    }
  }

  // Returns the side of the root at which the cable enters: one without a tree joint, border sides first; −1 if there
  // is none.
  [[nodiscard]] int entry_side(int root) const {
    int fallback = -1;
    for (int s = 0; s < 3; ++s) {
      if (is_border(graph_, g_.node[root], s)) return s;
      const int w = g_.neighbour[root][s];
      if (fallback < 0 && (w < 0 || std::ranges::count(tree_[root], w) == 0)) fallback = s;
    }
    return has_border_ ? -1 : fallback;
  }

  void grow(int root) {
    now_.order.assign(1, root);
    now_.parent.assign(1, -1);
    now_.depth.assign(1, 0);
    now_.sum_of_depths = now_.max_depth = 0;
    for (std::size_t k = 0; k < now_.order.size(); ++k) {
      const int from = now_.parent[k] < 0 ? -1 : now_.order[now_.parent[k]];
      for (const int w : tree_[now_.order[k]]) {
        if (w == from) continue;
        now_.order.push_back(w);
        now_.parent.push_back(static_cast<int>(k));
        now_.depth.push_back(now_.depth[k] + 1);
        now_.sum_of_depths += now_.depth.back();
        now_.max_depth = now_.depth.back();
      }
    }
  }

  [[nodiscard]] Key key(int violations, int hops) const {
    const bool loss_first = options_.objective == RouteObjective::kLossFirst;
    return {has_border_ ? 0 : 1, violations, loss_first ? now_.sum_of_depths : hops,
            loss_first ? hops : now_.sum_of_depths, now_.max_depth};
  }

  void try_root(int root) {
    const int side = entry_side(root);
    if (side < 0) return;
    grow(root);
    if (found_ && !(key(0, 0) < best_key_)) return;
    if (found_ && !(key(0, lines_.bound(now_.parent)) < best_key_)) return;
    const LineAssignment assignment = lines_.assign(now_.parent);
    const std::vector<LineElectrical> state = electrical(assignment.line, root);
    const int violations = static_cast<int>(
        std::ranges::count_if(state, [&](const LineElectrical& e) { return violates(options_.electrical, e); }));
    const Key k = key(violations, assignment.line_hops);
    if (found_ && !(k < best_key_)) return;
    found_ = true;
    best_key_ = k;
    best_ = now_;
    best_side_ = side;
    best_lines_ = assignment;
    best_state_ = state;
    best_violations_ = violations;
  }

  [[nodiscard]] std::vector<LineElectrical> electrical(const Numbers& line, int root) const {
    std::vector<LineElectrical> state;
    const double cable = cable_m(graph_, g_.node[root], options_);
    const std::vector<double> jumper_m = jumper_lengths_m();
    for (const LineLoad& load : line_loads(options_.electrical, now_.parent, line, options_.lines, cable, jumper_m)) {
      state.push_back(electrical_state(options_.electrical, load));
    }
    return state;
  }

  // Returns the jumper length of the joint from each node of the tree to its parent; -1 if it is no jumper. Empty if
  // there is none at all.
  [[nodiscard]] std::vector<double> jumper_lengths_m() const {
    if (jumpers_.empty()) return {};
    std::vector<double> length_m(now_.order.size(), -1.0);
    for (std::size_t k = 1; k < now_.order.size(); ++k) {
      const int v = g_.node[now_.order[k]], p = g_.node[now_.order[now_.parent[k]]];
      for (const Jumper& j : jumpers_) {
        if (j.node == std::array{std::min(v, p), std::max(v, p)}) length_m[k] = j.length_mm * 1e-3;
      }
    }
    return length_m;
  }

  Patch assemble() const {
    Patch patch;
    patch.entry = g_.node[best_.order[0]];
    patch.line_hops = best_lines_.line_hops;
    patch.max_depth = best_.max_depth;
    patch.border_entry = is_border(graph_, patch.entry, best_side_);
    patch.lines = best_state_;
    patch.electrical_violations = best_violations_;
    Numbers next_address(at(options_.lines), 0), tree_parent(g_.node.size(), -1);
    for (std::size_t k = 0; k < best_.order.size(); ++k) {
      RoutedModule m;
      const int p = best_.parent[k] < 0 ? -1 : best_.order[best_.parent[k]];
      m.node = g_.node[best_.order[k]];
      m.parent = p < 0 ? -1 : g_.node[p];
      m.depth = best_.depth[k];
      m.line = best_lines_.line[k];
      m.address = next_address[m.line]++;
      m.rotation = best_side_;
      for (int s = 0; s < 3 && p >= 0; ++s) {
        if (graph_.nodes[at(m.node)].neighbour[at(s)] == m.parent) m.rotation = s;
      }
      tree_parent[best_.order[k]] = p;
      patch.modules.push_back(m);
    }
    for (const Joint& j : joints_of(g_)) {
      if (tree_parent[j.a] != j.b && tree_parent[j.b] != j.a) patch.cut_joints.push_back({g_.node[j.a], g_.node[j.b]});
    }
    return patch;
  }

  const ModuleGraph& graph_;
  LocalGraph g_;
  const RoutingOptions& options_;
  LineAssigner& lines_;
  std::vector<Jumper> jumpers_;  // These jumpers begin in this part.
  Table<int, Numbers> tree_;
  bool has_border_ = false, found_ = false;
  RootedTree now_, best_;
  Key best_key_{};
  int best_side_ = -1, best_violations_ = 0;
  LineAssignment best_lines_;
  std::vector<LineElectrical> best_state_;
};

}  // namespace

bool is_border(const ModuleGraph& graph, int node, int side) {
  const ModuleGraph::Node& n = graph.nodes[at(node)];
  return n.neighbour[at(side)] < 0 && n.border[at(side)];
}

double cable_m(const ModuleGraph& graph, int node, const RoutingOptions& options) {
  if (!options.has_controller_place) return options.electrical.cable_m;
  double square = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double d = graph.nodes[at(node)].center_mm[k] - options.controller_mm[k];
    square += d * d;
  }
  return std::sqrt(square) * 1e-3;
}

Patch wire(const ModuleGraph& graph, const Numbers& part, const RoutingOptions& options, LineAssigner& lines,
           const std::vector<Jumper>& jumpers) {
  return Wirer(graph, part, options, lines, jumpers).run();
}

}  // namespace triskin::routing

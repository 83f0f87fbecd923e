// SPDX-License-Identifier: GPL-3.0-or-later
#include "failures.hpp"

#include <algorithm>
#include <tuple>

#include "part_bits.hpp"
#include "spanning_trees.hpp"
#include "wiring.hpp"

namespace triskin::routing {
namespace {

constexpr int kBorderWorth = 6;  // A border entry is worth this many modules.

struct Failure {
  int dead = -1;                      // The failed node has this local number.
  std::array<int, 2> broken{-1, -1};  // Parent and child have local numbers.
};

// Holds owner and depth of every node, shared by all patches of a result.
struct Ownership {
  Numbers patch, depth;
};

class PatchAnalysis {
 public:
  PatchAnalysis(const ModuleGraph& graph, const RoutingOptions& options, const std::vector<Patch>& patches,
                const Ownership& owner, Patch& patch)
      : graph_(graph),
        options_(options),
        patches_(patches),
        owner_(owner),
        patch_(patch),
        g_(local(graph, patch)),
        bits_(g_) {
    tree_parent_.assign(g_.node.size(), -1);
    size_.assign(g_.node.size(), 1);
    for (const RoutedModule& m : patch.modules) {
      if (m.parent >= 0) tree_parent_[index(m.node)] = index(m.parent);
    }
    for (auto m = patch.modules.rbegin(); m != patch.modules.rend(); ++m) {
      if (m->parent >= 0) size_[index(m->parent)] += size_[index(m->node)];
    }
    entry_ = index(patch.entry);
    // The cable of an inner entry occupies a joint, which is lost permanently.
    const int behind = g_.neighbour[entry_][patch.modules[0].rotation];
    if (behind >= 0) {
      bits_.cut(entry_, behind);
      for (int& w : g_.neighbour[entry_]) w = w == behind ? -1 : w;
      for (int& w : g_.neighbour[behind]) w = w == entry_ ? -1 : w;
    }
    for (int v = 0; v < g_.size(); ++v) failures_.push_back({v, {-1, -1}});
    for (int v = 0; v < g_.size(); ++v) {
      if (v != entry_) failures_.push_back({-1, {tree_parent_[v], v}});
    }
  }

  // A patch that is kept has its second cable already, or none, and the table of its controller says so: it stays
  // where it still has a place.
  void plan(bool is_kept) {
    weak_points();
    if (is_kept && options_.second_entry && second_entry_has_place()) return;
    patch_.second_entry = patch_.second_entry_side = -1;
    if (options_.second_entry) choose_second_entry();
  }

  void run() {
    patch_.failures.clear();
    for (const Failure& f : failures_) patch_.failures.push_back(loss(f));
  }

 private:
  static LocalGraph local(const ModuleGraph& graph, const Patch& patch) {
    Numbers nodes;
    for (const RoutedModule& m : patch.modules) nodes.push_back(m.node);
    return localize(graph, std::move(nodes));
  }
  [[nodiscard]] int index(int node) const {
    return static_cast<int>(std::ranges::lower_bound(g_.node, node) - g_.node.begin());
  }

  [[nodiscard]] std::uint32_t reached(const Failure& f, std::uint32_t seeds) const {
    const std::uint32_t allowed = f.dead >= 0 ? bits_.all & ~(1U << f.dead) : bits_.all;
    if (f.dead >= 0) return bits_.reach(seeds, allowed);
    PartBits bits = bits_;
    bits.cut(f.broken[0], f.broken[1]);
    return bits.reach(seeds, allowed);
  }

  void weak_points() {
    patch_.articulation.clear();
    patch_.bridges.clear();
    for (int v = 0; v < g_.size() && g_.size() > 1; ++v) {
      const std::uint32_t rest = bits_.all & ~(1U << v);
      if (bits_.reach(rest & (~rest + 1), rest) != rest) patch_.articulation.push_back(g_.node[v]);
    }
    for (const Joint& j : joints_of(g_)) {
      PartBits bits = bits_;
      bits.cut(j.a, j.b);
      if (bits.reach(1U << j.a, bits.all) != bits.all) patch_.bridges.push_back({g_.node[j.a], g_.node[j.b]});
    }
  }

  [[nodiscard]] int total_reached(std::uint32_t seeds) const {
    int sum = 0;
    for (const Failure& f : failures_) sum += std::popcount(reached(f, seeds));
    return sum;
  }

  void choose_second_entry() {
    patch_.second_entry_saves = 0;
    const int without = total_reached(1U << entry_);
    int best = 0;
    for (int v = 0; v < g_.size(); ++v) {
      if (v == entry_) continue;
      const auto [side, border] = connector_side(v);
      if (side < 0) continue;
      const int saves = total_reached(1U << entry_ | 1U << v) - without;
      // A cable from outside is worth a few modules over all failures; an inner entry is taken only if it saves clearly
      // more.
      const int score = saves > 0 ? saves + (border ? kBorderWorth : 0) : 0;
      if (score <= best) continue;
      best = score;
      patch_.second_entry = g_.node[v];
      patch_.second_entry_side = side;
      patch_.second_entry_border = border;
      patch_.second_entry_saves = saves;
    }
  }

  // The patch has the joints that it had; what lies beyond them can have changed.
  [[nodiscard]] bool second_entry_has_place() {
    if (patch_.second_entry < 0) return true;
    const int v = index(patch_.second_entry), side = patch_.second_entry_side;
    patch_.second_entry_border = is_border(graph_, patch_.second_entry, side);
    patch_.second_entry_saves = total_reached(1U << entry_ | 1U << v) - total_reached(1U << entry_);
    if (patch_.second_entry_border) return true;
    const int across = graph_.nodes[at(patch_.second_entry)].neighbour[at(side)];
    return options_.second_entry_at_seam && across >= 0 && owner_.patch[across] != owner_.patch[patch_.entry] &&
           !plugs(patches_[at(owner_.patch[across])], across, patch_.second_entry);
  }

  // Returns a side without a joint of this patch, best on the border; otherwise at the seam to another patch. −1 if
  // there is none.
  [[nodiscard]] std::pair<int, bool> connector_side(int v) const {
    int seam = -1;
    for (int s = 0; s < 3; ++s) {
      if (is_border(graph_, g_.node[v], s)) return {s, true};
      const int across = graph_.nodes[at(g_.node[v])].neighbour[at(s)];
      if (seam < 0 && across >= 0 && owner_.patch[across] != owner_.patch[patch_.entry] && !cable_between(v, across))
        seam = s;
    }
    return {options_.second_entry_at_seam ? seam : -1, false};
  }

  FailureLoss loss(const Failure& f) {
    FailureLoss result;
    result.node = g_.node[f.dead >= 0 ? f.dead : f.broken[1]];
    result.other_node = f.dead >= 0 ? -1 : g_.node[f.broken[0]];
    result.lost_strapped = size_[f.dead >= 0 ? f.dead : f.broken[1]];
    result.lost_one_entry = g_.size() - std::popcount(reached(f, 1U << entry_));
    regrow(f);
    result.lost_rerouted = static_cast<int>(std::ranges::count_if(depth_, [](int d) { return d < 0; }));
    for (int v = 0; v < g_.size(); ++v) {
      if (depth_[v] < 0 || parent_[v] == tree_parent_[v]) continue;
      result.backup_tree.push_back({g_.node[v], parent_[v] < 0 ? -1 : g_.node[parent_[v]]});
    }
    if (options_.adoption) adopt(f, result);
    result.lost_backed_up = result.lost_rerouted - static_cast<int>(result.adopted.size());
    return result;
  }

  [[nodiscard]] bool usable(const Failure& f, int a, int b) const {
    if (a < 0 || b < 0 || a == f.dead || b == f.dead) return false;
    return !(f.dead < 0 && ((a == f.broken[0] && b == f.broken[1]) || (a == f.broken[1] && b == f.broken[0])));
  }

  // Takes `v` into the live tree below `parent`, together with everything connected to it by tree joints: the subtree
  // is re-rooted, not rebuilt.
  void attach(const Failure& f, int v, int parent) {
    std::vector<std::array<int, 2>> queue{{v, parent}};
    for (std::size_t k = 0; k < queue.size(); ++k) {
      const auto [u, p] = queue[k];
      parent_[u] = p;
      depth_[u] = p < 0 ? 0 : depth_[p] + 1;
      for (const int w : g_.neighbour[u]) {
        const bool tree_joint = w >= 0 && (tree_parent_[w] == u || tree_parent_[u] == w);
        if (tree_joint && usable(f, u, w) && depth_[w] < 0 && w != p) queue.push_back({w, u});
      }
    }
  }

  void regrow(const Failure& f) {
    parent_.assign(g_.node.size(), -1);
    depth_.assign(g_.node.size(), -1);
    if (entry_ != f.dead) attach(f, entry_, -1);
    rejoin(f);
    if (patch_.second_entry < 0) return;
    const int second = index(patch_.second_entry);
    if (second == f.dead || depth_[second] >= 0) return;
    attach(f, second, -1);
    rejoin(f);
  }

  // Joins the shallowest live module to an unreachable one, repeatedly.
  void rejoin(const Failure& f) {
    for (;;) {
      std::tuple<int, int, int> best{1 << 20, -1, -1};
      for (int u = 0; u < g_.size(); ++u) {
        if (depth_[u] < 0) continue;
        for (const int w : g_.neighbour[u]) {
          if (usable(f, u, w) && depth_[w] < 0) best = std::min(best, {depth_[u], u, w});
        }
      }
      const auto [depth, u, w] = best;
      if (u < 0) return;
      attach(f, w, u);
    }
  }

  // Orphans that touch another patch with free addresses are read by it, the one nearest to its entry first.
  void adopt(const Failure& f, FailureLoss& result) const {
    Numbers adopter(g_.node.size(), -1), depth(g_.node.size(), 0);
    std::vector<std::array<int, 2>> taken;  // Each entry is a patch and the number of modules it takes.
    for (;;) {
      std::tuple<int, int, int> best{1 << 20, -1, -1};  // The entries are depth, unreachable module and parent node.
      for (int v = 0; v < g_.size(); ++v) {
        if (depth_[v] >= 0 || v == f.dead || adopter[v] >= 0) continue;
        for (const int node : graph_.nodes[at(g_.node[v])].neighbour) consider(f, v, node, adopter, depth, taken, best);
      }
      const auto [d, v, node] = best;
      if (v < 0) return;
      const bool inside = owner_.patch[node] == owner_.patch[patch_.entry];
      adopter[v] = inside ? adopter[index(node)] : owner_.patch[node];
      depth[v] = d + 1;
      const auto row = std::ranges::find(taken, adopter[v], [](const auto& t) { return t[0]; });
      if (row == taken.end())
        taken.push_back({adopter[v], 1});
      else
        ++(*row)[1];
      result.adopted.push_back({g_.node[v], node});
    }
  }

  void consider(const Failure& f, int v, int node, const Numbers& adopter, const Numbers& depth,
                const std::vector<std::array<int, 2>>& taken, std::tuple<int, int, int>& best) const {
    if (node < 0) return;
    int patch = owner_.patch[node], d = owner_.depth[node];
    if (patch == owner_.patch[patch_.entry]) {
      const int w = index(node);
      if (!usable(f, v, w) || adopter[w] < 0 || std::ranges::count(g_.neighbour[v], w) == 0) return;
      patch = adopter[w];
      d = depth[w];
    } else if (cable_between(v, node)) {
      return;
    }
    const auto row = std::ranges::find(taken, patch, [](const auto& t) { return t[0]; });
    const int used = static_cast<int>(patches_[at(patch)].modules.size()) + (row == taken.end() ? 0 : (*row)[1]);
    if (used < options_.lines * options_.addresses) best = std::min(best, {d, v, node});
  }

  // Returns true if a cable of the patch is plugged in at the side of `from` that leads to `to`.
  [[nodiscard]] bool plugs(const Patch& p, int from, int to) const {
    const auto& sides = graph_.nodes[at(from)].neighbour;
    return (p.entry == from && sides[at(p.modules[0].rotation)] == to) ||
           (p.second_entry == from && sides[at(p.second_entry_side)] == to);
  }

  // Returns true if a cable, this patch's or the other's, occupies the joint of v and the node.
  [[nodiscard]] bool cable_between(int v, int node) const {
    const Patch& other = patches_[at(owner_.patch[node])];
    const int mine = g_.node[v];
    return plugs(other, node, mine) || plugs(patch_, mine, node);
  }

  const ModuleGraph& graph_;
  const RoutingOptions& options_;
  const std::vector<Patch>& patches_;
  const Ownership& owner_;
  Patch& patch_;
  LocalGraph g_;
  PartBits bits_;
  int entry_ = 0;
  Numbers tree_parent_, size_, parent_, depth_;
  std::vector<Failure> failures_;
};

}  // namespace

void analyse_failures(const ModuleGraph& graph, const RoutingOptions& options, std::vector<Patch>& patches,
                      const std::vector<bool>& is_kept) {
  Ownership owner{Numbers(graph.nodes.size(), -1), Numbers(graph.nodes.size(), 0)};
  for (std::size_t p = 0; p < patches.size(); ++p) {
    for (const RoutedModule& m : patches[p].modules) {
      owner.patch[m.node] = static_cast<int>(p);
      owner.depth[m.node] = m.depth;
    }
  }
  // Every connector is planned before losses are counted, because it occupies a joint that adoption could use.
  for (std::size_t p = 0; p < patches.size(); ++p) {
    if (!patches[p].is_gap())
      PatchAnalysis(graph, options, patches, owner, patches[p]).plan(p < is_kept.size() && is_kept[p]);
  }
  for (Patch& patch : patches) {
    if (!patch.is_gap()) PatchAnalysis(graph, options, patches, owner, patch).run();
  }
}

}  // namespace triskin::routing

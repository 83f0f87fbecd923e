// SPDX-License-Identifier: GPL-3.0-or-later
// Solves small patches by trying everything: partitions by subsets, trees by subsets of joints, lines by all
// assignments.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "shapes.hpp"

namespace triskin::testing {
namespace {

constexpr int kCapacity = 4, kLines = 2, kAddresses = 2;

bool connected(const design::ModuleGraph& g, unsigned set) {
  unsigned seen = set & (~set + 1), front = seen;
  while (front != 0) {
    unsigned next = 0;
    for (std::size_t v = 0; v < g.nodes.size(); ++v) {
      if ((front >> v & 1) == 0) continue;
      for (const int w : g.nodes[v].neighbour) next |= w >= 0 ? 1U << w : 0U;
    }
    front = next & set & ~seen;
    seen |= front;
  }
  return seen == set;
}

int fewest_parts(const design::ModuleGraph& g) {
  const unsigned all = (1U << g.nodes.size()) - 1;
  std::vector<bool> is_part(all + 1, false);
  for (unsigned set = 1; set <= all; ++set) is_part[set] = std::popcount(set) <= kCapacity && connected(g, set);
  std::vector<int> best(all + 1, 1 << 20);
  best[0] = 0;
  for (unsigned set = 1; set <= all; ++set) {
    const unsigned lowest = set & (~set + 1);
    for (unsigned part = set; part != 0; part = (part - 1) & set) {
      if ((part & lowest) != 0 && is_part[part]) best[set] = std::min(best[set], best[set & ~part] + 1);
    }
  }
  return best[all];
}

struct SmallTree {
  std::vector<int> parent, depth;  // The index is the position in the part.
};

// Returns the fewest hops of a rooted tree over all assignments of lines.
int fewest_hops(const SmallTree& t) {
  const std::size_t n = t.parent.size();
  int best = 1 << 20;
  for (unsigned code = 0; code < (1U << n); ++code) {
    const int on_one = std::popcount(code);
    if (on_one > kAddresses || static_cast<int>(n) - on_one > kAddresses) continue;
    std::vector<unsigned> used(n, 0);
    for (std::size_t v = 0; v < n; ++v) {
      for (int u = static_cast<int>(v); u >= 0; u = t.parent[static_cast<std::size_t>(u)])
        used[static_cast<std::size_t>(u)] |= 1U << (code >> v & 1);
    }
    int hops = 0;
    for (std::size_t v = 0; v < n; ++v) hops += t.parent[v] >= 0 ? std::popcount(used[v]) : 0;
    best = std::min(best, hops);
  }
  return best;
}

// Returns (no border entry, Σ depth, hops, depth), or hops before Σ depth, over all joint subsets and entries.
std::array<int, 4> best_wiring(const design::ModuleGraph& g, const std::vector<int>& part, bool hops_first) {
  std::vector<std::array<int, 2>> joints;
  const auto index = [&](int node) { return static_cast<int>(std::ranges::find(part, node) - part.begin()); };
  const int n = static_cast<int>(part.size());
  bool has_border = false;
  const auto border = [&](int v) {
    return std::ranges::any_of(g.nodes[static_cast<std::size_t>(part[static_cast<std::size_t>(v)])].neighbour,
                               [](int w) { return w < 0; });
  };
  for (int v = 0; v < n; ++v) {
    has_border = has_border || border(v);
    for (const int w : g.nodes[static_cast<std::size_t>(part[static_cast<std::size_t>(v)])].neighbour) {
      if (w >= 0 && index(w) < n && index(w) > v) joints.push_back({v, index(w)});
    }
  }
  std::array<int, 4> best{1 << 20, 0, 0, 0};
  for (unsigned chosen = 0; chosen < (1U << joints.size()); ++chosen) {
    if (std::popcount(chosen) != n - 1) continue;
    for (int root = 0; root < n; ++root) {
      int degree = 0;
      for (std::size_t k = 0; k < joints.size(); ++k)
        degree += (chosen >> k & 1) != 0 && (joints[k][0] == root || joints[k][1] == root) ? 1 : 0;
      if (degree > 2 || (has_border && !border(root))) continue;
      SmallTree t{std::vector<int>(static_cast<std::size_t>(n), -1), std::vector<int>(static_cast<std::size_t>(n), -1)};
      t.depth[static_cast<std::size_t>(root)] = 0;
      for (int round = 0; round < n; ++round) {
        for (std::size_t k = 0; k < joints.size(); ++k) {
          if ((chosen >> k & 1) == 0) continue;
          for (const auto& [a, b] : {std::pair(joints[k][0], joints[k][1]), std::pair(joints[k][1], joints[k][0])}) {
            auto& d = t.depth[static_cast<std::size_t>(b)];
            if (t.depth[static_cast<std::size_t>(a)] < 0 || d >= 0) continue;
            d = t.depth[static_cast<std::size_t>(a)] + 1;
            t.parent[static_cast<std::size_t>(b)] = a;
          }
        }
      }
      if (std::ranges::min(t.depth) < 0) continue;
      int sum = 0;
      for (const int d : t.depth) sum += d;
      const int hops = fewest_hops(t);
      best = std::min(
          best, {has_border ? 0 : 1, hops_first ? hops : sum, hops_first ? sum : hops, std::ranges::max(t.depth)});
    }
  }
  return best;
}

void compare(const Listed& patch, bool hops_first) {
  routing::RoutingOptions options;
  options.capacity = kCapacity;
  options.lines = kLines;
  options.addresses = kAddresses;
  if (hops_first) options.objective = routing::RouteObjective::kHopsFirst;
  const routing::RoutingResult r = routing::route(patch.graph, options);
  ASSERT_TRUE(r.proved);
  EXPECT_EQ(static_cast<int>(r.patches.size()), fewest_parts(patch.graph));
  for (const design::Patch& p : r.patches) {
    std::vector<int> part;
    int sum = 0;
    for (const design::RoutedModule& m : p.modules) {
      part.push_back(m.node);
      sum += m.depth;
    }
    const std::array<int, 4> key{p.border_entry ? 0 : 1, hops_first ? p.line_hops : sum, hops_first ? sum : p.line_hops,
                                 p.max_depth};
    EXPECT_EQ(key, best_wiring(patch.graph, part, hops_first));
  }
}

TEST(RoutingBruteForce, agrees_on_five_hundred_patches) {
  constexpr std::array kShapes{Shape::kCompact, Shape::kStrip, Shape::kHoled, Shape::kDendritic};
  for (int k = 0; k < 500; ++k) {
    SCOPED_TRACE(k);
    const int n = 1 + k % 14;
    compare(random_patch(kShapes[static_cast<std::size_t>(k / 14 % 4)], n, 1000 + static_cast<std::uint64_t>(k)),
            k % 2 == 1);
    if (HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace triskin::testing

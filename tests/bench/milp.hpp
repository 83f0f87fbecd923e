// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/design/jumper.hpp"
#include "triskin/design/module_graph.hpp"
#include "triskin/design/price.hpp"

namespace triskin::bench {

/// Bounds the fewest controllers from both sides. `upper` is 0 when the time limit passed before a partition of each
/// island was found.
struct PartitionInterval {
  int lower = 0, upper = 0;
  double seconds = 0.0;
};

/// Finds the fewest connected parts of at most `capacity` (≥ 1) modules, as a spanning forest of fewest roots that
/// CBC solves island by island: y_a = 1 when arc a leads from parent to child, r_v = 1 when v is a root, flow g_a =
/// size of the subtree behind a; every node has one arc in or is a root, s_v + inflow − outflow = 1 with s_v ≤
/// capacity · r_v, y_a ≤ g_a ≤ (capacity − 1) · y_a. The parts have no numbers, so there are no permutations to
/// search. This is the baseline that `triskin-bench routing` measures against. Cost: up to time_limit_s (> 0) per
/// island; the interval depends on the machine.
[[nodiscard]] PartitionInterval partition_by_milp(const design::ModuleGraph& graph, int capacity, double time_limit_s);

/// Bounds the least price of controllers and jumpers from both sides; `upper` is infinite without a solution.
struct PriceInterval {
  double lower = 0.0, upper = 0.0, seconds = 0.0;
};

/// The same programme where jumpers may be fitted at `places`: an arc across a jumper costs price.jumper, a root
/// price.controller. Cost: up to time_limit_s for each set of islands that the places join.
[[nodiscard]] PriceInterval price_by_milp(const design::ModuleGraph& graph, const std::vector<design::Jumper>& places,
                                          int capacity, const design::Price& price, double time_limit_s);

}  // namespace triskin::bench

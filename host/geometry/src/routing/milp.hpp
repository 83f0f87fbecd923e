// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "local_graph.hpp"

namespace triskin::geometry {

struct MilpAnswer {
  int lower_bound = 0;       ///< of the parts; at least the one that was given
  int parts = 0;             ///< 0: no solution found
  std::vector<int> part_of;  ///< by local node
};

/// Fewest connected parts ≤ capacity as a spanning forest of least roots, solved by CBC in this process: y_a = 1 when
/// arc a leads from parent to child, r_v = 1 when v is a root, flow g_a = size of the subtree behind a; every node has
/// one arc in or is a root, s_v + inflow − outflow = 1 with s_v ≤ capacity · r_v, y_a ≤ g_a ≤ (capacity −
/// 1) · y_a. No part has a number, so there are no permutations to search. `lower_bound` is added as a cut. Stops
/// after `time_limit_s`: the interval that it returns then depends on the machine. Cost: seconds to minutes.
[[nodiscard]] MilpAnswer divide_by_milp(const LocalGraph& g, int capacity, int lower_bound, double time_limit_s);

}  // namespace triskin::geometry

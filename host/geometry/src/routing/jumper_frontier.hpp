// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <vector>

#include "jumper_partition.hpp"

namespace triskin::geometry {

struct CheapestParts {
  bool decided = false;      ///< false: the budget ended first
  std::vector<int> part_of;  ///< by local node; empty: none is cheaper than the limit
  int parts = 0;
};

/// The cheapest partition among those that cost less than `limit`, exact: nodes are added one by one; a state keeps
/// which nodes with neighbours to come share a part, and the weight of each such part; of equal states the cheapest
/// stays. A state is dropped when its price and ⌈weight to come / capacity⌉ controllers reach the limit. Undecided
/// after `budget` transitions or where the frontier outgrows 12 nodes.
[[nodiscard]] CheapestParts cheapest_parts(const JumperGraph& g, int capacity, const IntegerPrice& price,
                                           std::int64_t limit, long budget);

}  // namespace triskin::geometry

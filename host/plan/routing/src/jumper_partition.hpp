// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "jumper_graph.hpp"

namespace triskin::routing {

struct JumperPartition {
  /// Each local node has its part, 0 … parts − 1; each part is connected in `joined` and ≤ capacity.
  Numbers part_of;
  int parts = 0, jumpers = 0;
  int parts_bound = 0;    ///< No partition has fewer parts, whatever its jumpers.
  int jumpers_bound = 0;  ///< No partition into `parts` parts has fewer jumpers.
  bool proved = false;    ///< No partition has a lower price.
};

/// Divides the graph into connected parts of at most `capacity` <= 16 nodes at the lowest price. Upper bound: trees and
/// moves (jumper_search.hpp). Lower bounds: parts of the whole graph; jumpers >= Σ parts of each island alone - parts,
/// since a part of p pieces has p − 1 jumpers; groups of islands (island_groups.hpp). If they do not meet, the groups
/// of the cheapest division into groups are settled one by one, each by the search and the exact programme of
/// jumper_frontier.hpp: the bound rises, or the groups together are cheaper than the best so far. Every budget is
/// counted, none timed. `give_up` is asked now and then; if it returns true, the cheapest partition so far is the
/// answer, with bounds that hold. Cost: 1 … 50 ms for 150 modules in 10 islands, up to 0.5 s if groups must be
/// settled by the exact programme.
[[nodiscard]] JumperPartition partition_with_jumpers(const JumperGraph& g, int capacity, const Price& price,
                                                     std::uint64_t seed, const std::function<bool()>& give_up = {});

}  // namespace triskin::routing

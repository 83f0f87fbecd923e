// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <vector>

#include "triskin/routing/jumper_graph.hpp"

namespace triskin::geometry {

struct CheapestParts {
  bool decided = false;      ///< It is false when the budget ended first.
  std::vector<int> part_of;  ///< Each local node has its part; it is empty when none is cheaper than the limit.
  int parts = 0;
};

/// A partition that costs less than `limit` and no more than any whose jumpers join all islands of the graph, exact:
/// nodes are added one by one; a jumper is fitted or not at its first end; a state keeps which slots (what nodes to
/// come can join) share a part, and the weight of each such part. Of the states with equal slots those stay that no
/// other beats in price and in every weight. It is dropped when its price, ⌈weight to come / capacity⌉ controllers
/// and the jumpers that islands to come need reach the limit. Several orders of the nodes are tried. Undecided after
/// `budget` transitions, which are counted down, or where slots or open parts outgrow their numbers.
[[nodiscard]] CheapestParts cheapest_parts(const JumperGraph& g, int capacity, const IntegerPrice& price,
                                           std::int64_t limit, long& budget);

}  // namespace triskin::geometry

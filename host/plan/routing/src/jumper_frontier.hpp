// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <vector>

#include "jumper_graph.hpp"

namespace triskin::routing {

struct CheapestParts {
  bool decided = false;  ///< False means that the budget ended first.
  Numbers part_of;       ///< Each local node has its part; the list is empty when none is cheaper than the limit.
  int parts = 0;
};

/// Finds the partition that costs less than `limit` and no more than any whose jumpers join all islands of the graph,
/// exactly: nodes are added one by one; a jumper is fitted or not at its first end; a state keeps which slots
/// (connections to later nodes) share a part, and the weight of each such part. Of the states with equal slots those
/// stay that no other beats in price and in every weight. A state is dropped when its price, ⌈remaining weight /
/// capacity⌉ controllers and the jumpers that later islands need reach the limit. Several orders of the nodes are
/// tried. Undecided after `budget` transitions, which are counted down, or if slots or open parts exceed their maximum
/// numbers.
[[nodiscard]] CheapestParts cheapest_parts(const JumperGraph& g, int capacity, const IntegerPrice& price,
                                           std::int64_t limit, long& budget);

}  // namespace triskin::routing

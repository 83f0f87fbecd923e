// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "local_graph.hpp"

namespace triskin::geometry {

/// A connected set of modules whose joints are of two kinds.
struct JumperGraph {
  LocalGraph joined;                             ///< joints and jumpers
  LocalGraph apart;                              ///< the same nodes, joints only
  std::vector<std::array<bool, 3>> over_jumper;  ///< by local node and side: the neighbour in `joined` is over a jumper
};
/// `without` must be `with` less its jumpers; `nodes` are connected in `with`.
[[nodiscard]] JumperGraph jumper_graph(const ModuleGraph& with, const ModuleGraph& without,
                                       const std::vector<int>& nodes);

/// Prices as integers, so that every compiler decides alike; among equal prices fewer controllers, then fewer jumpers.
struct IntegerPrice {
  std::int64_t part, jumper;
  explicit IntegerPrice(const Price& price);
  [[nodiscard]] std::int64_t of(int parts, int jumpers) const { return part * parts + jumper * jumpers; }
  /// A jumper costs less than the controller that it can save.
  [[nodiscard]] bool jumpers_pay() const { return jumper < part; }
};

struct JumperPartition {
  std::vector<int> part_of;  ///< by local node; parts 0 … parts − 1, each connected in `joined` and ≤ capacity
  int parts = 0, jumpers = 0;
  int parts_bound = 0;    ///< no partition has fewer parts, whatever its jumpers
  int jumpers_bound = 0;  ///< no partition into `parts` parts has fewer jumpers
  bool proved = false;    ///< no partition has a lower price
};
/// Jumpers that a partition needs: over all parts, the number of its pieces without jumpers, less one.
[[nodiscard]] int jumpers_of(const JumperGraph& g, const std::vector<int>& part_of, int parts);

/// Divides the graph into connected parts of at most `capacity` ≤ 16 nodes at the lowest price. Upper bound: random
/// spanning trees that take joints before jumpers, each divided exactly, over the whole and again over neighbouring
/// parts. Lower bounds: parts of the joined graph; jumpers ≥ Σ parts of each island alone − parts, since a part of p
/// pieces has p − 1 jumpers; last the exact programme of jumper_frontier.hpp. Every budget is counted, none timed.
/// `give_up` is asked now and then: true, and the cheapest found so far is the answer, with bounds that hold.
/// Cost: 1 … 400 ms for 150 modules, 0.3 ms a module for large graphs.
[[nodiscard]] JumperPartition partition_with_jumpers(const JumperGraph& g, int capacity, const Price& price,
                                                     std::uint64_t seed, const std::function<bool()>& give_up = {});

}  // namespace triskin::geometry

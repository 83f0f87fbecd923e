// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "local_graph.hpp"

namespace triskin::routing {

/// A connected set of modules whose joints are of two kinds.
struct JumperGraph {
  LocalGraph joined;  ///< This graph has joints and jumpers.
  LocalGraph apart;   ///< This graph has the same nodes with joints only.
  /// True if a jumper leads to the neighbour in `joined` at that side of the local node.
  Table<int, Triple<bool>> over_jumper;
};
/// `without` must be `with` minus its jumpers; `nodes` must be connected in `with`.
[[nodiscard]] JumperGraph jumper_graph(const ModuleGraph& with, const ModuleGraph& without, const Numbers& nodes);
/// Returns some local nodes of a graph, ascending, with the joints and jumpers among them; in the result `node` is the
/// local node of `g`.
[[nodiscard]] JumperGraph part_of_graph(const JumperGraph& g, const Numbers& nodes);
/// Returns the jumpers that a partition needs: summed over all parts, the number of its pieces without jumpers, less
/// one.
[[nodiscard]] int jumpers_of(const JumperGraph& g, const Numbers& part_of, int parts);

/// Prices are integers, so that every compiler decides alike; among equal prices fewer controllers win, then fewer
/// jumpers.
struct IntegerPrice {
  std::int64_t part, jumper;
  explicit IntegerPrice(const Price& price);
  [[nodiscard]] std::int64_t of(int parts, int jumpers) const { return part * parts + jumper * jumpers; }
  /// Returns true if a jumper costs less than the controller that it can save.
  [[nodiscard]] bool jumpers_pay() const { return jumper < part; }
};

}  // namespace triskin::routing

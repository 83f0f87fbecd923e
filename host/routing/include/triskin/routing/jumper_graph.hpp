// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "triskin/routing/local_graph.hpp"

namespace triskin::geometry {

/// A connected set of modules whose joints are of two kinds.
struct JumperGraph {
  LocalGraph joined;  ///< It has joints and jumpers.
  LocalGraph apart;   ///< It has the same nodes with joints only.
  /// Indexed by local node and side: the neighbour in `joined` is over a jumper.
  std::vector<std::array<bool, 3>> over_jumper;
};
/// `without` must be `with` less its jumpers; `nodes` are connected in `with`.
[[nodiscard]] JumperGraph jumper_graph(const ModuleGraph& with, const ModuleGraph& without,
                                       const std::vector<int>& nodes);
/// Some local nodes of a graph, ascending, and what joins them; in the result `node` is the local node of `g`.
[[nodiscard]] JumperGraph part_of_graph(const JumperGraph& g, const std::vector<int>& nodes);
/// Jumpers that a partition needs: over all parts, the number of its pieces without jumpers, less one.
[[nodiscard]] int jumpers_of(const JumperGraph& g, const std::vector<int>& part_of, int parts);

/// Prices as integers, so that every compiler decides alike; among equal prices fewer controllers, then fewer jumpers.
struct IntegerPrice {
  std::int64_t part, jumper;
  explicit IntegerPrice(const Price& price);
  [[nodiscard]] std::int64_t of(int parts, int jumpers) const { return part * parts + jumper * jumpers; }
  /// A jumper costs less than the controller that it can save.
  [[nodiscard]] bool jumpers_pay() const { return jumper < part; }
};

}  // namespace triskin::geometry

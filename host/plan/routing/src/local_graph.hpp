// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "triskin/base/dice.hpp"
#include "triskin/base/index.hpp"
#include "triskin/design/tables.hpp"
#include "triskin/routing/routing.hpp"

namespace triskin::routing {

/// A set of nodes of a module graph under local numbers 0 … n−1, with the joints among them.
struct LocalGraph {
  Numbers node;  ///< The list has nodes of the module graph in ascending order.
  /// Neighbours over each tile side have local numbers; −1 lies outside the set.
  Table<int, Triple<int>> neighbour;
  [[nodiscard]] int size() const { return static_cast<int>(node.size()); }
};
[[nodiscard]] LocalGraph localize(const ModuleGraph& graph, Numbers nodes);

/// Returns the connected components of the joints, each sorted, in the order of their least nodes. For a local graph
/// they contain local nodes.
[[nodiscard]] Table<int, Numbers> components(const ModuleGraph& graph);
[[nodiscard]] Table<int, Numbers> components(const LocalGraph& graph);

/// Lists the nodes of a spanning tree, parents before children; parent[k] belongs to order[k], −1 for the root.
struct SpanningTree {
  Numbers order;
  Numbers parent;
};
/// Draws a random spanning tree of the nodes v with part_of[v] == `part`, which must be connected; `root` is one of
/// them. Grows by a mixture of depth-first and random order, so that both stringy and bushy trees occur. Cost: O(n).
void random_tree(const LocalGraph& g, const Numbers& part_of, int part, int root, Dice& random, SpanningTree& tree);

}  // namespace triskin::routing

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "local_graph.hpp"

namespace triskin::routing {

/// The remaining graph after its pendant trees are folded into the nodes that carry them. Bottom-up, a node keeps its
/// lightest branches while they fit and closes the others as parts of their own: fewest closed parts first, then the
/// lightest rest, which is optimal because one more closed part can always free the node of its whole branch.
struct Folding {
  Table<int, Numbers> closed;  ///< These parts, in local nodes, are settled in some optimal partition.
  Numbers core;           ///< The core has the nodes on cycles or between them, and one node when the graph is a tree.
  Numbers branch_weight;  ///< Each node has the weight of the branches it keeps, 0 … capacity − 1.
  Table<int, Numbers> branch;  ///< Each node has the nodes of those branches.
};
/// Folds the nodes with part_of[v] == part.
[[nodiscard]] Folding fold(const LocalGraph& g, const Numbers& part_of, int part, int capacity);

/// Returns a bound: no partition of those nodes into connected parts ≤ capacity has fewer parts. It is closed parts +
/// ⌈rest / capacity⌉, valid also if a core node's branch is cut, since a branch weighs at most one part. Cost:
/// O(n).
[[nodiscard]] int folded_lower_bound(const LocalGraph& g, const Numbers& part_of, int part, int capacity);

}  // namespace triskin::routing

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

namespace triskin::geometry {

/// Rooted tree on nodes 0 … n−1 with parent[0] = −1 and parents before children; n ≤ lines · per_line.
struct LineAssignment {
  std::vector<int> line;  ///< of each node; at most `per_line` nodes on a line
  int line_hops = 0;      ///< Σ over edges of the number of lines that are used below the edge
};

/// Fewest line hops for the tree, exact: dynamic programme bottom-up over the sorted numbers of nodes that a subtree puts
/// on each line. Cost: n · (number of fills)², at most 70² · 24 steps an edge for four lines of four.
[[nodiscard]] LineAssignment assign_lines(const std::vector<int>& parent, int lines, int per_line);

}  // namespace triskin::geometry

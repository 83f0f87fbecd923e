// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/geometry/routing.hpp"

namespace triskin::geometry {

/// Connected components of the joints, each sorted.
[[nodiscard]] std::vector<std::vector<int>> components(const ModuleGraph& graph);

struct Partition {
  std::vector<std::vector<int>> parts;  ///< each connected, ≤ capacity, sorted
  int lower_bound = 0;
};
/// Divides one component into connected parts of at most `capacity` nodes: the best of many random spanning trees, each
/// cut bottom-up. Lower bound: pendant parts that no other part can serve, then the rest by size (docs/routing.md).
[[nodiscard]] Partition partition(const ModuleGraph& graph, const std::vector<int>& component, int capacity, std::uint64_t seed,
                                  double time_limit_s);

/// Fewest parts that any partition of the component has: from folding pendant trees.
[[nodiscard]] int folded_lower_bound(const ModuleGraph& graph, const std::vector<int>& component, int capacity);

}  // namespace triskin::geometry

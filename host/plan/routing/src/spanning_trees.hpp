// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <vector>

#include "local_graph.hpp"

namespace triskin::routing {

struct Joint {
  int a, b;
};
[[nodiscard]] std::vector<Joint> joints_of(const LocalGraph& g);

/// Calls `visit` with the joints of every spanning tree of a connected graph, each once, in a fixed order. A patch of
/// 16 modules has at most about a thousand. Cost: O(n) per tree.
void for_each_spanning_tree(const LocalGraph& g, const std::function<void(const std::vector<Joint>&)>& visit);

}  // namespace triskin::routing

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/geometry/routing.hpp"

namespace triskin::geometry {

/// Wires one connected part: entry, tree, line, address, rotation. Minimizes lexicographically the expected loss (sum of
/// depths), the line hops, the depth. Line hops are exact for each tree; trees are the breadth-first ones of every entry.
[[nodiscard]] Patch wire(const ModuleGraph& graph, const std::vector<int>& part, const RoutingOptions& options);

/// Fills patch.failures: what each single module or joint failure costs.
void analyse_failures(const ModuleGraph& graph, Patch& patch);

}  // namespace triskin::geometry

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "line_assignment.hpp"
#include "local_graph.hpp"

namespace triskin::routing {

/// Wires one connected part: the least (no border entry, lines against the electrical rule, Σ depth, line hops, depth)
/// over all spanning trees and entries, exact; with kHopsFirst the line hops come before Σ depth. Trees that cannot
/// win by ⌈size / addresses⌉ are not assigned. Ties are won by the first tree and the least node. `lines` must fit
/// the options. `jumpers` tells which joints of the graph are jumpers, for their capacitance.
[[nodiscard]] Patch wire(const ModuleGraph& graph, const Numbers& part, const RoutingOptions& options,
                         LineAssigner& lines, const std::vector<Jumper>& jumpers = {});

/// Returns the metres of entry cable to a module: from the controller place if one is given.
[[nodiscard]] double cable_m(const ModuleGraph& graph, int node, const RoutingOptions& options);

/// Returns true if a cable can come from outside at this side.
[[nodiscard]] bool is_border(const ModuleGraph& graph, int node, int side);

}  // namespace triskin::routing

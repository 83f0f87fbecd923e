// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "partition.hpp"

namespace triskin::geometry {

/// Secondary cost of a part, in integers so that every compiler decides alike: no border side ≫ modules that single failures
/// part from the rest > Σ depth from its best entry (compactness) > cable to the controller place.
[[nodiscard]] int secondary_cost(const ModuleGraph& graph, const LocalGraph& part, const RoutingOptions& options);

/// Lowers the sum of secondary costs under a fixed number of parts: joins two neighbouring parts, draws a random tree, cuts
/// it elsewhere (ReCom, DeFord, Duchin and Solomon 2021), accepts by a falling threshold. `moves` in all.
void recombine(const ModuleGraph& graph, const LocalGraph& g, const RoutingOptions& options, int moves, Random& random, Partition& partition);

}  // namespace triskin::geometry

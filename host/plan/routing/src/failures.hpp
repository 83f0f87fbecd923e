// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "local_graph.hpp"

namespace triskin::routing {

/// Fills, for every patch, the loss under each single failure of a module or tree joint, the backup trees, the second
/// entry that saves most, articulation modules and bridges. A switched patch re-joins every orphaned subtree where it
/// lies least deep; modules that no joint reaches are read through the second entry, then by neighbouring patches with
/// free addresses. Patches that are kept (by index) keep their second entry, or stay without, where it has a place.
void analyse_failures(const ModuleGraph& graph, const RoutingOptions& options, std::vector<Patch>& patches,
                      const std::vector<bool>& is_kept = {});

}  // namespace triskin::routing

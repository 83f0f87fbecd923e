// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "triskin/geometry/module_layout.hpp"
#include "triskin/geometry/surface.hpp"
#include "triskin/host/progress.hpp"

namespace triskin::geometry {

struct SurfaceLatticeOptions {
  double time_limit_s = 10.0;
  int chains = 2;               ///< independent searches, one thread each; the best one wins
  int layouts = 4;              ///< random layouts of a chain, of which it keeps the best
  int ruins = 1'000'000;        ///< ruin and recreate steps of a chain; with `layouts` the budget that makes a result repeatable
  std::uint64_t seed = 1;
  double island_cost = 0.02;    ///< modules that one more island must bring
};

/// Grows rigid modules directly on the surface: each open side rolls a new module onto the surface about its hinge, the
/// neighbourhood relaxes, and the module stays when every limit holds; a joint that does not close becomes a slit. What is left
/// is filled with further islands. Then balls of modules are taken away and grown anew, with annealing (ruin and recreate).
/// Same seed and same budget, not cut by the time limit: same result. Metrics are measured (map_modules.hpp). Cost: about 1.5 ms a tried module.
[[nodiscard]] ModuleLayout grow_lattice(const Surface& surface, const LayoutLimits& limits, const SurfaceLatticeOptions& options = {},
                                        const ProgressSink& progress = {});

}  // namespace triskin::geometry

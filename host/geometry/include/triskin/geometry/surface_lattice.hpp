// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "triskin/geometry/module_layout.hpp"
#include "triskin/geometry/surface.hpp"
#include "triskin/host/progress.hpp"

namespace triskin::geometry {

struct SurfaceLatticeOptions {
  double time_limit_s = 10.0;   ///< no new layout is begun after it
  int layouts = 1000;           ///< how many layouts are tried at most: the budget that makes a result repeatable
  int threads = 2;
  std::uint64_t seed = 1;
  double island_cost = 0.02;    ///< modules that one more island must bring
};

/// Grows rigid modules directly on the surface: each open side rolls a new module onto the surface about its hinge, the
/// neighbourhood relaxes, and the module stays when every limit holds; a joint that does not close becomes a slit. What is left
/// is filled with further islands. The best of many random layouts, several at once. Same seed and same number of finished
/// layouts: same result. Metrics are measured (map_modules.hpp). Cost: about 1.5 ms a tried module.
[[nodiscard]] ModuleLayout grow_lattice(const Surface& surface, const LayoutLimits& limits, const SurfaceLatticeOptions& options = {},
                                        const ProgressSink& progress = {});

}  // namespace triskin::geometry

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/design/design_types.hpp"
#include "triskin/mesh/surface.hpp"
#include "triskin/mesh/surface_regions.hpp"

namespace triskin::geometry {

/// A limit that a place for a module breaks.
struct BrokenLimit {
  std::string limit;      ///< It is the name in design files, "outward" (angle to the surface, rad) or "keep_out" (mm).
  double measured = 0.0;  ///< It is in the unit of the limit.
  double allowed = 0.0;   ///< A new module has to keep 98 % of the design's limit, so that other measurements agree.
  int other = -1;         ///< It is the module with which the limit is broken, where there is one.
};

/// Appends a module at free side `side` (0 … 2) of module `id`, in its island: the pose that keeps the limits best is
/// sought on the surface, and all other modules stay exactly where they are. It is joined across that side, and to
/// those other neighbours in the lattice to which the limits allow it. Metrics are not brought up to date: measure()
/// does that. Where no pose keeps the limits the layout stays as it was, and what the module would break without
/// sliding is returned, the worst first. Errors: std::out_of_range for an id or side that is not there; InputError when
/// the side carries a joint, or the island has its tile already (a slit). Deterministic. Cost: about 0.5 s.
/// `regions` of the surface, or null: what must stay free of modules is a limit as well.
[[nodiscard]] std::vector<BrokenLimit> add_module(const Surface& surface, const LayoutLimits& limits,
                                                  const SurfaceRegions* regions, ModuleLayout& layout, int id,
                                                  int side);

}  // namespace triskin::geometry

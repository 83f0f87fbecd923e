// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/design/design_types.hpp"
#include "triskin/mesh/surface.hpp"
#include "triskin/mesh/surface_regions.hpp"

namespace triskin::lattice {

/// Tells which limit a place for a module breaks.
struct BrokenLimit {
  /// The limit is named as in design files, or "outward" (angle to the surface, rad) or "keep_out" (mm).
  std::string limit;
  double measured = 0.0;  ///< The value has the unit of the limit.
  double allowed = 0.0;   ///< A new module must keep 98 % of the design's limit, so that other measurements agree.
  int other = -1;         ///< The module with which the limit is broken; −1 if there is none.
};

/// Appends a module at free side `side` (0 … 2) of module `id`, in its island. It seeks the pose on the surface that
/// keeps the limits best, and all other modules stay exactly where they are. The module is joined across that side, and
/// to those other neighbours in the lattice for which the limits allow it. Metrics are not updated: measure() does
/// that. If no pose keeps the limits, the layout stays unchanged and the limits that the module would break without
/// sliding are returned, the worst first. Errors: std::out_of_range for an id or side that does not exist; InputError
/// when the side carries a joint, or the island already has the tile (a slit). Deterministic. Cost: about 0.5 s. With
/// `regions` of the surface (may be null) areas that must stay free of modules are a limit as well.
[[nodiscard]] std::vector<BrokenLimit> add_module(const mesh::Surface& surface, const LayoutLimits& limits,
                                                  const mesh::SurfaceRegions* regions, ModuleLayout& layout, int id,
                                                  int side);

}  // namespace triskin::lattice

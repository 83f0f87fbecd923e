// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

#include "triskin/design/design_types.hpp"
#include "triskin/mesh/surface.hpp"
#include "triskin/mesh/surface_regions.hpp"

namespace triskin::lattice {

/// Runs measure_on_surface() for the modules from `first` on, on all processors.
void measure_modules(const mesh::Surface& surface, ModuleLayout& layout, std::size_t first,
                     const mesh::SurfaceRegions* regions);

/// Returns true if the surface nearest to a module's middle faces another way: a rib, or the other side of a thin wall.
/// The module would be measured against that. Cost: one closest point.
[[nodiscard]] bool is_turned(const mesh::Surface& surface, const PlacedModule& module);

/// Does what keep_limits() does, for a layout already measured by measure_on_surface().
void keep_limits_as_measured(const mesh::Surface& surface, const LayoutLimits& limits, ModuleLayout& layout);

}  // namespace triskin::lattice

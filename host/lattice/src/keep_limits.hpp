// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>

#include "triskin/design/design_types.hpp"
#include "triskin/mesh/surface.hpp"
#include "triskin/mesh/surface_regions.hpp"

namespace triskin::geometry {

/// measure_on_surface() of the modules from `first` on, on all processors.
void measure_modules(const Surface& surface, ModuleLayout& layout, std::size_t first, const SurfaceRegions* regions);

/// True if the surface nearest to a module's middle faces another way: a rib, or the other side of a thin wall. The
/// module would be measured against that. Cost: a closest point.
[[nodiscard]] bool is_turned(const Surface& surface, const PlacedModule& module);

/// keep_limits() of a layout whose modules are as measure_on_surface() left them.
void keep_limits_as_measured(const Surface& surface, const LayoutLimits& limits, ModuleLayout& layout);

}  // namespace triskin::geometry

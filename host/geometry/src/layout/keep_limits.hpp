// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/geometry/design_types.hpp"
#include "triskin/geometry/surface.hpp"

namespace triskin::geometry {

/// keep_limits() of a layout whose modules are as measure_on_surface() left them.
void keep_limits_as_measured(const Surface& surface, const LayoutLimits& limits, ModuleLayout& layout);

}  // namespace triskin::geometry

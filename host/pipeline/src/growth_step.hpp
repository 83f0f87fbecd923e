// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "design_in_work.hpp"
#include "searched_surface.hpp"
#include "triskin/mesh/surface_regions.hpp"

namespace triskin::pipeline {

/// Names of the steps after the growth, for which it reserves time as soon as it has a layout to measure them by.
inline constexpr const char* kPricingStep = "pricing";
inline constexpr const char* kWiringStep = "wiring";

/// The layouts grown on the surface, best first, until `end_s` of the budget, or less where the steps that follow turn
/// out to take longer. `regions` of the original, or null.
[[nodiscard]] std::vector<design::ModuleLayout> grown_layouts(DesignInWork& work, const SearchedSurface& searched,
                                                              const geometry::SurfaceRegions* regions, double end_s);

}  // namespace triskin::pipeline

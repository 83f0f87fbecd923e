// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "design_in_work.hpp"
#include "searched_surface.hpp"
#include "triskin/mesh/surface_regions.hpp"

namespace triskin::pipeline {

/// Grows layouts on the surface until `end_s` of the budget, or less if the steps that follow turn out to take longer,
/// and returns them, the best first. `regions` belong to the original and may be null.
[[nodiscard]] std::vector<design::ModuleLayout> grown_layouts(DesignInWork& work, const SearchedSurface& searched,
                                                              const mesh::SurfaceRegions* regions, double end_s);

}  // namespace triskin::pipeline

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/base/progress.hpp"
#include "triskin/design/design.hpp"
#include "triskin/mesh/surface.hpp"
#include "triskin/mesh/surface_regions.hpp"

namespace triskin::pipeline {

/// Wires `now`, whose modules are measured, around the controllers of `old` that can stay: those whose modules all stay
/// (`new_id` gives the present id by old id, −1: gone), with joints and jumpers as they were. Returns for each
/// controller of `old` its index now, −1 if its table changed. A controller that stays keeps its index, unless fewer
/// controllers are left than that index needs. `regions` of the surface may be null. Cost: twice that of wire().
std::vector<int> wire_around(const design::Design& old, design::Design& now, const mesh::Surface& surface,
                             const mesh::SurfaceRegions* regions, const std::vector<int>& new_id,
                             const ProgressSink& progress);

}  // namespace triskin::pipeline

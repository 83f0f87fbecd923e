// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/base/progress.hpp"
#include "triskin/design/design.hpp"
#include "triskin/mesh/surface.hpp"
#include "triskin/mesh/surface_regions.hpp"

namespace triskin::pipeline {

/// Wires `now`, whose modules are measured, around the controllers of `old` that can stay: those whose modules all stay
/// (`new_id` gives the present id by old id, −1: gone), with joints and jumpers as they were. Returns these; each
/// keeps its number, and new controllers take free numbers. `regions` of the surface may be null. Cost: twice that of
/// wire().
std::vector<layout::PatchIndex> wire_around(const design::Design& old, design::Design& now,
                                            const mesh::Surface& surface, const mesh::SurfaceRegions* regions,
                                            const std::vector<int>& new_id, const ProgressSink& progress);

}  // namespace triskin::pipeline

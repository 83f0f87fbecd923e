// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <vector>

#include "triskin/design/design_types.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::routing {

/// Returns the length of a cable that runs from a to b (mm, mesh frame) along the surface: 32 equal steps of the
/// straight line are moved to their closest points of the surface, at a height interpolated between those of a and b.
/// Cost: 34 closest points.
[[nodiscard]] double jumper_length_mm(const mesh::Surface& surface, const Vec3& a, const Vec3& b);

/// Finds possible places of jumpers: free sides of modules of different islands that face each other
/// (docs/design_file.md, Jumpers), not longer than limits.jumper_mm, folded by no more than limits.fold_rad, across no
/// module by more than limits.penetration_mm. Shortest first; each side and each pair of modules once, and none across
/// another, so that any of them may be fitted together. Of two places that exclude each other the one in `fitted` is
/// listed (cables that are there; node[0] < node[1]), or else the shorter. layout.jumpers is not read. Empty when
/// limits.jumper_mm is 0. Thread-safe. Cost: about 1 ms for 150 modules.
[[nodiscard]] std::vector<Jumper> find_jumpers(const mesh::Surface& surface, const ModuleLayout& layout,
                                               const LayoutLimits& limits, std::span<const Jumper> fitted = {});

}  // namespace triskin::routing

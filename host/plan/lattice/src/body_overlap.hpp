// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "triskin/design/design_types.hpp"

namespace triskin::lattice {

/// Modules whose normals have a lower cosine (more than 101.5° between them) are compared as bodies: seen along the
/// mean of such normals both are slivers.
inline constexpr double kBodiesBelow = -0.2;

/// Returns the shortest way in mm that separates the bodies of two modules, 0 when they are apart. A body stands on the
/// outline of its module (corners in mm, counter-clockwise; less the corner cut) and is as high as the soft layer, 2 mm
/// (docs/limits.md). Separating axes in space; some µs.
[[nodiscard]] double body_overlap_mm(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b, double corner_cut_mm);

}  // namespace triskin::lattice

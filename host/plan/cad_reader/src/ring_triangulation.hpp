// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

namespace triskin::cad_reader {

/// Returns triangles between closed rings in the plane, counter-clockwise, by the index of their corners over all rings
/// in their order: constrained Delaunay, inside an odd number of rings. Returns nothing if rings cross or corners of
/// two rings coincide. Uses CGAL; kept apart from the kernel's headers, whose macros clash with it. Cost: O(n log n).
[[nodiscard]] std::optional<std::vector<std::array<int, 3>>> triangulate_rings(
    const std::vector<std::vector<Eigen::Vector2d>>& rings);

}  // namespace triskin::cad_reader

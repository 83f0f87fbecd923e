// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <set>
#include <utility>
#include <vector>

#include "cut_surface.hpp"
#include "triskin/unfolding/seams.hpp"

namespace triskin::geometry {

/// Returns the shortest path along edges from the border of a set of faces (cuts count as border) to the vertex that
/// lies farthest from it. Edges in `uncut` (vertex pairs, lower first) are not used. Empty when no vertex lies inside.
/// Cost: O(n log n).
[[nodiscard]] std::vector<SurfaceEdge> deepest_dart(const CutSurface& cut, const std::vector<int>& faces,
                                                    const std::set<std::pair<int, int>>& uncut);

}  // namespace triskin::geometry

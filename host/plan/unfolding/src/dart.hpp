// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <set>
#include <utility>
#include <vector>

#include "cut_surface.hpp"
#include "triskin/unfolding/seams.hpp"

namespace triskin::unfolding {

/// Names an edge by its two vertices, the lower one first.
using VertexPair = std::pair<VertexIndex, VertexIndex>;

/// Returns the shortest path along edges from the border of a set of faces (cuts count as border) to the vertex that
/// lies farthest from it. Edges in `uncut` are not used. Empty when no vertex lies inside.
/// Cost: O(n log n).
[[nodiscard]] std::vector<SurfaceEdge> deepest_dart(const CutSurface& cut, const std::vector<FaceIndex>& faces,
                                                    const std::set<VertexPair>& uncut);

}  // namespace triskin::unfolding

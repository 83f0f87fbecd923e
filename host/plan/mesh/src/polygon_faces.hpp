// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/design/design_types.hpp"

namespace triskin::mesh {

/// Appends the triangles of a polygon whose corners are vertices of the mesh. It clips ears on the plane of the largest
/// projection, so that a polygon with a reflex corner is not covered twice. Fewer than three corners give none. Cost:
/// O(n³) at worst, O(n) for a convex polygon.
void add_polygon(Mesh& mesh, std::vector<VertexIndex> corners);

}  // namespace triskin::mesh

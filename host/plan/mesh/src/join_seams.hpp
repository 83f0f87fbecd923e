// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/mesh/mesh_io.hpp"

namespace triskin::mesh {

/// Joins faces that lie against each other without sharing an edge. Border vertices within `within_mm` of each other
/// become one, and a border edge on which vertices of another border lie is divided at them (a T-junction), where that
/// gives its face a neighbour. No point moves farther than `within_mm`. Counts both in the report. Faces may lose their
/// area. Cost: O(n), and O(b log b) of b border edges.
void join_seams(Mesh& mesh, double within_mm, MeshReadReport& report);

}  // namespace triskin::mesh

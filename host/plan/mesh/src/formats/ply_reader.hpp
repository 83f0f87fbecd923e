// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "mesh_source.hpp"

namespace triskin::mesh {

/// Reads vertices and faces of a PLY file, text or binary of either byte order, in the precision of the file: x, y, z
/// of `vertex`, the list `vertex_indices` (or `vertex_index`) of `face` and of `tristrips`; other elements and
/// properties are skipped. Errors: InputError naming the byte and the fault, also if the file ends early or continues
/// beyond what its header states, and for a point cloud. Cost: linear.
[[nodiscard]] Mesh read_ply(const MeshSource& source);

}  // namespace triskin::mesh

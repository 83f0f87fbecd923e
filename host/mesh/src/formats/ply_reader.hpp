// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "mesh_source.hpp"

namespace triskin::geometry {

/// Vertices and faces of a PLY file, text or binary of either byte order, in the precision of the file: x, y, z of
/// `vertex`, the list `vertex_indices` (or `vertex_index`) of `face` and of `tristrips`; other elements and properties
/// are skipped. Errors: InputError naming the byte and what is wrong, also where the file ends early or more follows
/// than its header says, and for a cloud of points. Cost: linear.
[[nodiscard]] Mesh read_ply(const MeshSource& source);

}  // namespace triskin::geometry

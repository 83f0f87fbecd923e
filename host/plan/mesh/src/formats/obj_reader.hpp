// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "mesh_source.hpp"

namespace triskin::mesh {

/// Reads vertices and faces of a Wavefront OBJ text in double precision: polygons, indices from the end, continued
/// lines. Objects are those of `o` (the rest of the line) and groups of `g` (each word). The format has no end mark, so
/// a last line without a line end and vertices that no face uses give notes; so do words that OBJ does not know.
/// Errors: InputError naming the line. Cost: linear.
[[nodiscard]] Mesh read_obj(const MeshSource& source);

}  // namespace triskin::mesh

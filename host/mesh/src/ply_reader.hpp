// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "triskin/design/design_types.hpp"

namespace triskin::geometry {

/// Vertices and faces of a PLY file, text or binary of either byte order, in the precision of the file: x, y, z of
/// `vertex`, the list `vertex_indices` (or `vertex_index`) of `face` and of `tristrips`; other elements and properties
/// are skipped. Errors: InputError naming `file` and what is wrong. Cost: linear.
[[nodiscard]] Mesh read_ply(const std::string& bytes, const std::string& file);

}  // namespace triskin::geometry

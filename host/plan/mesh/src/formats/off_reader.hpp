// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "mesh_source.hpp"

namespace triskin::mesh {

/// Reads a text OFF file (Geomview's format; also with ST, C, N and 4 before the word). Homogeneous coordinates (4OFF)
/// are divided by the fourth. A file that does not keep each vertex and face on a line of its own is read word by word.
/// Polygons are cut into triangles. Every count and index is checked. Errors: InputError naming the line; binary OFF
/// and nOFF are named. Cost: linear.
[[nodiscard]] Mesh read_off(const MeshSource& source);

/// Tells whether the text begins with the header of an OFF file.
[[nodiscard]] bool is_off(std::string_view text);

}  // namespace triskin::mesh

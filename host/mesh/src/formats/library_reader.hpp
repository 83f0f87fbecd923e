// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "mesh_source.hpp"

namespace triskin::geometry {

/// Reads a file with assimp (DAE and what else it knows) in a child process that ends after a time; objects are the
/// nodes of the scene, by their own or their mesh's name. `extension` (with the dot) says the format. Coordinates are
/// the file's, whatever axis it calls up; a node that mirrors turns its faces. Errors: InputError in our own words
/// where it cannot be read, and where the library crashes or does not end.
[[nodiscard]] MeshInUnit read_with_library(const MeshSource& source, const std::string& extension);

}  // namespace triskin::geometry

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "mesh_source.hpp"

namespace triskin::mesh {

/// Reads a file with assimp (DAE and its other formats) in a child process with a time limit; objects are the nodes of
/// the scene, by their own or their mesh's name. `extension` (with the dot) names the format. Coordinates stay as in
/// the file, whichever axis points up; a node that mirrors turns its faces. Errors: InputError in our own words if the
/// file cannot be read, and if the library crashes or does not end.
[[nodiscard]] MeshInUnit read_with_library(const MeshSource& source, const std::string& extension);

}  // namespace triskin::mesh

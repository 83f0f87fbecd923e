// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "mesh_source.hpp"

namespace triskin::mesh {

/// Reads COLLADA with assimp in a child process with a time limit; objects are the nodes of the scene, by their own or
/// their mesh's name. Coordinates stay as in the file, whichever axis points up; a node that mirrors turns its faces.
/// Errors: InputError in our own words if the file cannot be read, and if the library crashes or does not end.
[[nodiscard]] MeshInUnit read_dae(const MeshSource& source);

}  // namespace triskin::mesh

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "mesh_source.hpp"

namespace triskin::mesh {

/// Reads glTF 2.0 and GLB: the triangles, strips and fans of the default scene (the first one if none is named, all
/// nodes if there is no scene) at the places of its nodes, in metres and with y up, as the file has them. A node that
/// mirrors turns its faces. Objects are nodes and meshes by their names. Buffers in files are looked for beside the
/// file. Meshes of a skin stay in the pose in which they are stored, with a note; so do instances of an extension.
/// Errors: InputError naming the fault, every index and length that leaves its list, and a required extension that this
/// reader does not support. Cost: linear.
[[nodiscard]] MeshInUnit read_gltf(const MeshSource& source);

}  // namespace triskin::mesh

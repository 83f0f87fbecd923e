// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "design_in_work.hpp"
#include "triskin/mesh/mesh_io.hpp"

namespace triskin::pipeline {

/// Reads the mesh file, and stores its scale and its source in the design. Errors: as mesh::read_mesh().
[[nodiscard]] mesh::MeshFile read_part(DesignInWork& work);

/// Makes the surface to cover: repairs the mesh by `end_s` of the budget, turns it over if that was asked, takes the
/// wanted side, bridges small holes and resolves the regions. Returns false if both sides of a wall look alike; then
/// nothing is covered, and notes.part and notes.side hold what the caller has to ask. Errors: InputError for a mesh
/// that cannot be repaired.
[[nodiscard]] bool make_surface(DesignInWork& work, const mesh::MeshFile& file, double end_s);

}  // namespace triskin::pipeline

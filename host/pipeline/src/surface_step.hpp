// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "design_in_work.hpp"
#include "triskin/mesh/mesh_io.hpp"

namespace triskin::pipeline {

/// Reads the mesh file, and keeps in the design what the file says of it. Errors: as geometry::read_mesh().
[[nodiscard]] geometry::MeshFile read_part(DesignInWork& work);

/// Area of all faces of a mesh, mm².
[[nodiscard]] double area_mm2_of(const geometry::Mesh& mesh);

/// Makes the surface that is covered: repaired, turned over where that was asked, the wanted side alone, its small
/// holes bridged; with its regions. False where both sides of a wall look alike: nothing is covered, and notes.part and
/// notes.side say what to ask. `end_s`: when the repair should end. Errors: InputError for a mesh that cannot be
/// mended.
[[nodiscard]] bool make_surface(DesignInWork& work, const geometry::MeshFile& file, double end_s);

}  // namespace triskin::pipeline

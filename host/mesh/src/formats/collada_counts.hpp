// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "mesh_source.hpp"

namespace triskin::geometry {

/// Holds a COLLADA text against what it says of itself, which the library that reads it does not: the number of values
/// of each array, of the corners of each polygon, and of the triangles. Returns the length of its unit in mm, 0 where
/// it states none. Throws InputError naming file and line where the text is no XML, where a list has another length
/// than it says, and where a value is no number. Cost: linear.
[[nodiscard]] double checked_collada_unit_mm(const MeshSource& source);

}  // namespace triskin::geometry

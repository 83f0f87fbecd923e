// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "mesh_source.hpp"

namespace triskin::mesh {

/// Checks the counts that a COLLADA text states, which the library does not check: the values of each array, the
/// corners of each polygon, and the triangles. Returns the length of its unit in mm, or 0 if it states none. Throws
/// InputError naming file and line if the text is not XML, a list has another length than stated, a value is not a
/// number, or a node has what the library cannot read: a skew, or itself among its instances. Cost: linear.
[[nodiscard]] double checked_collada_unit_mm(const MeshSource& source);

}  // namespace triskin::mesh

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/design/design_types.hpp"

namespace triskin::mesh {

/// Tells which way the faces of a part with a border face. A closed part has an outside, an open one has two sides.
struct OpenSide {
  bool is_open = false;  ///< True if some edge has a single face.
  /// This mean of the unit normals over the area is shorter than 1 if they turn.
  design::Vec3 normal = design::Vec3::Zero();
  double toward_middle = 0.0;  ///< This fraction (0 … 1) of the area faces the middle of the part.
};

/// Measures which way the faces of a mesh face. Cost: linear in the faces. Threads: any.
[[nodiscard]] OpenSide open_side_of(const design::Mesh& mesh);

/// Reverses the orientation of every face.
void turn_over(design::Mesh& mesh);

}  // namespace triskin::mesh

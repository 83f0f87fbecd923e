// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/design/design_types.hpp"

namespace triskin::geometry {

/// Side to which the faces of a part with a border look. A closed part has an outside, an open one has two sides.
struct OpenSide {
  bool is_open = false;  ///< Some edge has a single face.
  /// It is the mean of the unit normals over the area, and is shorter than 1 where they turn.
  design::Vec3 normal = design::Vec3::Zero();
  double toward_middle = 0.0;  ///< It is the share of the area (0 … 1) that looks at the middle of the part.
};

/// Measures the side to which the faces of a mesh look. Cost: linear in the faces. Threads: any.
[[nodiscard]] OpenSide open_side_of(const design::Mesh& mesh);

/// Turns every face over.
void turn_over(design::Mesh& mesh);

}  // namespace triskin::geometry

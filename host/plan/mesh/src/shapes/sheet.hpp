// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

#include "triskin/design/design_types.hpp"

namespace triskin::mesh {

/// Describes a surface over the unit square and what is cut away from it.
struct Sheet {
  std::function<Vec3(double u, double v)> place;  ///< The function returns mm, and ∂u × ∂v points outwards.
  /// The surface stays wherever this value (mm) is positive; an empty function keeps everything.
  std::function<double(const Vec3&)> keep;
  double aspect = 1.0;  ///< The grid has this many cells along u for each cell along v.
  bool closed = false;  ///< True for a closed shape, in which u = 1 meets u = 0, as on a tube.
};

/// Makes about `faces` triangles (within a fifth) of irregular size and direction, as CAD programs do. The border
/// follows keep = 0. Equal arguments give equal meshes. Cost: linear in the faces.
[[nodiscard]] Mesh mesh_of(const Sheet& sheet, int faces);

/// Removes the vertices that no face uses.
[[nodiscard]] Mesh without_unused_vertices(const Mesh& mesh);

}  // namespace triskin::mesh

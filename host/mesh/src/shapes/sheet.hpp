// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

#include "triskin/design/design_types.hpp"

namespace triskin::geometry {

/// Surface over the unit square, with what is cut away.
struct Sheet {
  std::function<Vec3(double u, double v)> place;  ///< It returns mm, and ∂u × ∂v points outwards.
  /// It is positive, in mm, where the surface stays; an empty function keeps everything.
  std::function<double(const Vec3&)> keep;
  double aspect = 1.0;  ///< The grid has so many cells along u for each along v.
  bool closed = false;  ///< In a closed shape u = 1 is u = 0, as on a tube.
};

/// Triangles of irregular size and direction, as CAD programs make them, about `faces` of them (within a fifth). The
/// border follows keep = 0. Equal for equal arguments. Cost: linear in the faces.
[[nodiscard]] Mesh mesh_of(const Sheet& sheet, int faces);

/// The same without the vertices that no face names.
[[nodiscard]] Mesh without_unused_vertices(const Mesh& mesh);

}  // namespace triskin::geometry

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

#include "triskin/design/design_types.hpp"

namespace triskin::geometry {

/// Surface over the unit square, with what is cut away.
struct Sheet {
  std::function<Vec3(double u, double v)> place;  ///< mm; ∂u × ∂v points outwards
  std::function<double(const Vec3&)> keep;        ///< mm, positive where the surface stays; empty: everywhere
  double aspect = 1.0;                            ///< grid cells along u for one along v
  bool closed = false;                            ///< u = 1 is u = 0: a tube
};

/// Triangles of irregular size and direction, as CAD programs make them, about `faces` of them (within a fifth). The
/// border follows keep = 0. Equal for equal arguments. Cost: linear in the faces.
[[nodiscard]] Mesh mesh_of(const Sheet& sheet, int faces);

/// The same without the vertices that no face names.
[[nodiscard]] Mesh without_unused_vertices(const Mesh& mesh);

}  // namespace triskin::geometry

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "triskin/geometry/module_layout.hpp"
#include "triskin/geometry/types.hpp"

namespace triskin::geometry {

/// One unfolded piece with its map back to the surface.
struct Piece {
  Polygon outline;                                 ///< mm, simple, true scale
  std::vector<int> faces;                          ///< mesh face of each flat triangle
  std::vector<std::array<Vec2, 3>> flat;           ///< corner positions of `faces`, same corner order as the mesh
  double max_edge_error_mm = 0.0;                  ///< largest |flat − surface| edge length, scaled to a 30 mm edge
  double rms_edge_error_mm = 0.0;
};

struct Net {
  std::vector<Piece> pieces;
  int overlaps = 0;  ///< pairs of flat triangles of one piece that overlap; 0 in a valid net
};

}  // namespace triskin::geometry

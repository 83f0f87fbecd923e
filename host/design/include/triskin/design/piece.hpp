// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "triskin/design/polygon.hpp"

namespace triskin::design {

/// One unfolded piece of the surface with its map back: flat triangle k shows mesh face faces[k].
struct Piece {
  Polygon outline;                        ///< It is simple, in mm, at true scale.
  std::vector<int> faces;                 ///< Each flat triangle has its index in Mesh::faces.
  std::vector<std::array<Vec2, 3>> flat;  ///< They are the flat corners of `faces`, in the order of the mesh.
  double max_edge_error_mm = 0.0;         ///< largest |flat − surface| edge length, scaled to a 30 mm edge
  double rms_edge_error_mm = 0.0;
};

/// Rigid motion that carries a polygon (p, mm) onto the isometric grid (q, mm): q = R(theta)·p + (x, y); theta in rad,
/// counter-clockwise.
struct Placement {
  double x_mm = 0.0;
  double y_mm = 0.0;
  double theta_rad = 0.0;
};

/// A piece as it lies on the grid, before its modules are mapped back to the surface.
struct PlacedPiece {
  Piece piece;
  Placement placement;
  int modules = 0;      ///< It counts tiles wholly inside the piece.
  int upper_bound = 0;  ///< No placement of this piece has more.
  bool proved = true;   ///< It says that modules == upper_bound; a piece smaller than a module holds none.
};

}  // namespace triskin::design

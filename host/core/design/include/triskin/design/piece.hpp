// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "triskin/design/polygon.hpp"

namespace triskin::design {

/// A piece is an unfolded part of the surface with its map back: flat triangle k corresponds to mesh face faces[k].
struct Piece {
  Polygon outline;                        ///< The outline is a simple polygon in mm, at true scale.
  std::vector<FaceIndex> faces;           ///< Each flat triangle is listed with its face of the surface.
  std::vector<std::array<Vec2, 3>> flat;  ///< Corners are flat and follow the order of the corners in the mesh.
  /// No edge differs more in length between plane and surface, scaled to an edge of 30 mm.
  double max_edge_error_mm = 0.0;
  double rms_edge_error_mm = 0.0;
};

/// A placement is a rigid motion that maps a polygon (p, mm) onto the isometric grid (q, mm): q = R(theta)·p + (x, y);
/// theta is in rad, counter-clockwise.
struct Placement {
  double x_mm = 0.0;
  double y_mm = 0.0;
  double theta_rad = 0.0;
};

/// A piece is placed on the grid before its modules are mapped back to the surface.
struct PlacedPiece {
  Piece piece;
  Placement placement;
  int modules = 0;      ///< Only tiles that lie completely inside the piece count.
  int upper_bound = 0;  ///< No placement of this piece has more modules.
  bool proved = true;   ///< True means that modules == upper_bound; a piece smaller than a module has no module at all.
};

}  // namespace triskin::design

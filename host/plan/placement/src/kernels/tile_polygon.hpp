// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cmath>
#include <vector>

#include "kernels/tile_grid.hpp"

namespace triskin::placement {

/// A polygon prepared for placement: recentred, as edges with the interior on the left.
struct PreparedPolygon {
  Vec2 first = Vec2::Zero();  ///< This vertex is subtracted first, because inputs may lie 1e6 mm away.
  /// The centre is subtracted next, because a short lever arm keeps rotation bounds tight.
  Vec2 center = Vec2::Zero();
  /// Separations are rounded by up to 1e-9 mm, and in proportion to a radius above some 100 m.
  double rounding_mm = 1e-9;
  std::vector<std::array<Vec2, 2>> edges;
  /// These arrays hold the edges in the order of `edges`: first end, left unit normal, its product with the first end,
  /// and the edge that starts at the second end.
  std::vector<double> x, y, normal_x, normal_y, line_offset;
  std::vector<std::uint32_t> next;
  double radius_mm = 0.0;  ///< A circle of this radius around the centre holds the polygon.
  /// Edges are sorted into horizontal slabs, so that a point-in-polygon test reads only those that its ray may meet.
  double slab_low = 0.0, slab_height = 1.0;
  std::vector<std::vector<int>> slabs;

  [[nodiscard]] bool contains(const Vec2& p) const;
};
[[nodiscard]] PreparedPolygon prepare(const Polygon& polygon);

/// A motion of the recentred polygon: q = R(theta)·p + (x, y).
struct Motion {
  double x = 0.0, y = 0.0, theta = 0.0;
};
[[nodiscard]] Motion to_motion(const PreparedPolygon& polygon, const Placement& placement);
[[nodiscard]] Placement to_placement(const PreparedPolygon& polygon, const Motion& motion);

}  // namespace triskin::placement

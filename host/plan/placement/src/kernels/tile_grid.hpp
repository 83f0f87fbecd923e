// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "triskin/placement/placement.hpp"

namespace triskin::placement {

/// Describes places and shape of the modules: convex tiles on a lattice with rows along x. Triangles come in two kinds,
/// up and down, mirror images of each other; squares and hexagons only as "up".
struct TileGrid {
  int corners = 3;
  int kinds = 2;
  int neighbours = 3;          ///< A tile has this many neighbours across sides of full length.
  double row_step_mm = 0.0;    ///< The lattice repeats along a row after this step in x.
  double row_height_mm = 0.0;  ///< Rows follow each other at this step in y.
  double row_shift_mm = 0.0;   ///< Each row is shifted by this much in x against the one below.
  double period_rad = 0.0;     ///< Turned by this angle, the lattice maps onto itself.
  double inradius_mm = 0.0, circumradius_mm = 0.0, area_mm2 = 0.0;
  std::array<Vec2, 2> origin;  ///< Tile (0, 0) has its centre here: index 1 is up, 0 is down.
  /// The corners of the up tile run counter-clockwise around its centre, and the normals point outward.
  std::array<Vec2, 6> corner, normal;
  std::array<double, 6> offset_mm{};  ///< No side is nearer to the centre than inradius_mm.

  [[nodiscard]] Vec2 center(const Tile& t) const {
    const Vec2& o = origin[t.up ? 1 : 0];
    return {o.x() + row_step_mm * t.i + row_shift_mm * t.j, o.y() + row_height_mm * t.j};
  }
};

/// Returns the tiles that share a side with `t`: grid.neighbours of them; the rest of the array is unused.
[[nodiscard]] std::array<Tile, 6> neighbours(const TileGrid& grid, const Tile& t);

/// Lays out modules with sides of 30 mm; `gap_mm` is the free space between facing sides. Triangles may have their
/// corners cut off, `corner_cut_mm` along each side (design/outline.hpp): such tiles have six corners with long and
/// short sides alternating, at the places of the triangles.
[[nodiscard]] TileGrid tile_grid(TileShape shape, double gap_mm, double corner_cut_mm = 0.0);

}  // namespace triskin::placement

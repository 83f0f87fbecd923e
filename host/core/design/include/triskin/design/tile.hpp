// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cmath>
#include <compare>

#include "triskin/design/mesh.hpp"

namespace triskin::design {

/// A module has sides of length a, in mm.
inline constexpr double kSide_mm = 30.0;
/// The height of a module is h = a·√3/2, in mm.
inline constexpr double kHeight_mm = 25.980762113533160;
/// The area of a module is a·h/2, in mm².
inline constexpr double kModuleArea_mm2 = 389.71143170299738;

/// Lattice coordinates in a file may not be larger; the limit exceeds any cover and still fits into an int.
inline constexpr int kMaxLattice = 1'000'000;

/// A tile is one triangle of the isometric grid (docs/design_file.md). Grid vertex (i, j) lies at (a(i + j/2), h·j).
/// The up triangle (i, j) has corners (i,j), (i+1,j), (i,j+1); the down one (i, j) has (i+1,j), (i+1,j+1), (i,j+1).
/// Both are listed counter-clockwise; side s runs from corner s to corner (s+1) % 3.
struct Tile {
  int i = 0;
  int j = 0;
  bool up = true;
  auto operator<=>(const Tile&) const = default;
};

/// Returns the grid vertex (i, j) of corner `corner` of a tile; any number other than 0 … 2 is treated as 2.
[[nodiscard]] constexpr std::array<int, 2> tile_corner_index(const Tile& t, int corner) {
  if (t.up)
    return corner == 0 ? std::array{t.i, t.j} : corner == 1 ? std::array{t.i + 1, t.j} : std::array{t.i, t.j + 1};
  return corner == 0 ? std::array{t.i + 1, t.j} : corner == 1 ? std::array{t.i + 1, t.j + 1} : std::array{t.i, t.j + 1};
}

/// Returns the position of grid vertex (i, j) in the plane of the grid for side length `side_mm` > 0, mm.
[[nodiscard]] inline Vec2 grid_point(int i, int j, double side_mm = kSide_mm) {
  return {side_mm * (i + 0.5 * j), side_mm * 0.86602540378443864676 * j};
}

/// The side of the tile is 0 … 2.
struct TileSide {
  Tile tile;
  int side = 0;
  bool operator==(const TileSide&) const = default;
};
/// Returns the neighbour across side `side` (0 … 2) of a tile, with the side of the neighbour that both share: Up
/// side
/// 0 ↔ down (i, j-1) side 1; up side 1 ↔ down (i, j) side 2; up side 2 ↔ down (i-1, j) side 0. Applying across()
/// to the result leads back to (t, side).
[[nodiscard]] constexpr TileSide across(const Tile& t, int side) {
  if (t.up) {
    if (side == 0) return {{t.i, t.j - 1, false}, 1};
    if (side == 1) return {{t.i, t.j, false}, 2};
    return {{t.i - 1, t.j, false}, 0};
  }
  if (side == 0) return {{t.i + 1, t.j, true}, 2};
  if (side == 1) return {{t.i, t.j + 1, true}, 0};
  return {{t.i, t.j, true}, 1};
}

}  // namespace triskin::design

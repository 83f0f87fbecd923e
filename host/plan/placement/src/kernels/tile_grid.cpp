// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernels/tile_grid.hpp"

#include <cmath>

#include "triskin/design/outline.hpp"

namespace triskin::placement {
namespace {

constexpr double kHalfRoot3 = 0.86602540378443864676;

void fill_outline(TileGrid& g, double first_angle) {
  const double step = 2.0 * M_PI / g.corners;
  g.circumradius_mm = 0.5 * kSide_mm / std::sin(0.5 * step);
  g.inradius_mm = 0.5 * kSide_mm / std::tan(0.5 * step);
  g.area_mm2 = 0.5 * g.corners * kSide_mm * g.inradius_mm;
  for (int k = 0; k < g.corners; ++k) {
    const double c = first_angle + step * k, n = c + 0.5 * step;
    g.corner[static_cast<std::size_t>(k)] = g.circumradius_mm * Vec2(std::cos(c), std::sin(c));
    g.normal[static_cast<std::size_t>(k)] = {std::cos(n), std::sin(n)};
    g.offset_mm[static_cast<std::size_t>(k)] = g.inradius_mm;
  }
}

// Each corner becomes two, with a short side across the line from the centre.
void cut_corners(TileGrid& g, double cut_mm) {
  const TileGrid whole = g;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec2 &from = whole.corner[k], &to = whole.corner[(k + 1) % 3], step = cut_mm / kSide_mm * (to - from);
    g.corner[2 * k] = from + step;
    g.corner[2 * k + 1] = to - step;
    g.normal[2 * k] = whole.normal[k];
    g.normal[2 * k + 1] = to.normalized();
    g.offset_mm[2 * k] = whole.offset_mm[k];
    g.offset_mm[2 * k + 1] = design::short_side_offset_mm(cut_mm);
  }
  g.corners = 6;
  g.circumradius_mm = g.corner[0].norm() * (1.0 + 1e-15);
  g.area_mm2 = design::module_area_mm2(cut_mm);
}

TileGrid triangles(double gap_mm, double corner_cut_mm) {
  TileGrid g;
  // Facing sides move apart by 1/√3 of the growth of the pitch.
  const double pitch = kSide_mm + 2.0 * kHalfRoot3 * gap_mm;
  g.row_step_mm = pitch;
  g.row_shift_mm = 0.5 * pitch;
  g.row_height_mm = kHalfRoot3 * pitch;
  g.period_rad = M_PI / 3.0;
  g.origin = {Vec2(pitch, g.row_height_mm * 2.0 / 3.0), Vec2(0.5 * pitch, g.row_height_mm / 3.0)};
  fill_outline(g, -5.0 * M_PI / 6.0);
  if (corner_cut_mm > 0.0) cut_corners(g, corner_cut_mm);
  return g;
}

TileGrid squares(double gap_mm) {
  TileGrid g;
  g.corners = g.neighbours = 4;
  g.kinds = 1;
  g.row_step_mm = g.row_height_mm = kSide_mm + gap_mm;
  g.period_rad = M_PI / 2.0;
  g.origin[1] = Vec2(0.5 * g.row_step_mm, 0.5 * g.row_height_mm);
  fill_outline(g, -3.0 * M_PI / 4.0);
  return g;
}

// The hexagons point upwards, so that those of a row touch with their vertical sides.
TileGrid hexagons(double gap_mm) {
  TileGrid g;
  g.corners = g.neighbours = 6;
  g.kinds = 1;
  g.row_step_mm = 2.0 * kHalfRoot3 * kSide_mm + gap_mm;
  g.row_shift_mm = 0.5 * g.row_step_mm;
  g.row_height_mm = kHalfRoot3 * g.row_step_mm;
  g.period_rad = M_PI / 3.0;
  g.origin[1] = Vec2(0.5 * g.row_step_mm, 0.5 * g.row_height_mm);
  fill_outline(g, -M_PI / 2.0);
  return g;
}

}  // namespace

std::array<Tile, 6> neighbours(const TileGrid& grid, const Tile& t) {
  if (grid.neighbours == 3) return {across(t, 0).tile, across(t, 1).tile, across(t, 2).tile};
  const auto at = [&](int i, int j) { return Tile{t.i + i, t.j + j, true}; };
  if (grid.neighbours == 4) return {at(1, 0), at(-1, 0), at(0, 1), at(0, -1)};
  return {at(1, 0), at(-1, 0), at(0, 1), at(0, -1), at(1, -1), at(-1, 1)};
}

TileGrid tile_grid(TileShape shape, double gap_mm, double corner_cut_mm) {
  switch (shape) {
    case TileShape::kSquare:
      return squares(gap_mm);
    case TileShape::kHexagon:
      return hexagons(gap_mm);
    default:
      return triangles(gap_mm, corner_cut_mm);
  }
}

}  // namespace triskin::placement

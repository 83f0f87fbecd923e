// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/design/tile.hpp"

namespace triskin::test {

/// Makes a design without modules on the rectangle from `low_mm` to `high_mm` of the plane z = 0.
inline design::Design flat_design(const std::string& name, const design::Vec2& low_mm, const design::Vec2& high_mm) {
  design::Design d;
  d.name = name;
  d.source_file = name + ".obj";
  d.surface.vertices = {{low_mm.x(), low_mm.y(), 0},
                        {high_mm.x(), low_mm.y(), 0},
                        {high_mm.x(), high_mm.y(), 0},
                        {low_mm.x(), high_mm.y(), 0}};
  d.surface.faces = {{0, 1, 2}, {0, 2, 3}};
  d.layout.islands = 1;
  d.layout.method = design::LayoutMethod::kSurface;
  return d;
}

/// Appends a module at each of `tiles`, moved by `shift_mm`, to an island. `number` has the id of the module at each
/// tile: adjacent tiles there are joined.
inline void lay_modules(design::Design& d, const std::vector<design::Tile>& tiles,
                        const std::map<design::Tile, int>& number, int island = 0,
                        const design::Vec2& shift_mm = {0, 0}) {
  for (const design::Tile& t : tiles) {
    design::PlacedModule m;
    m.island = island;
    m.tile = t;
    for (int k = 0; k < 3; ++k) {
      const auto [i, j] = design::tile_corner_index(t, k);
      const design::Vec2 p = design::grid_point(i, j) + shift_mm;
      m.corner_mm[static_cast<std::size_t>(k)] = design::Vec3{p.x(), p.y(), 0.0};
      const auto other = number.find(design::across(t, k).tile);
      m.neighbour[static_cast<std::size_t>(k)] = other == number.end() ? -1 : other->second;
    }
    d.layout.modules.push_back(m);
  }
}

}  // namespace triskin::test

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <random>
#include <vector>

#include "triskin/geometry/lattice.hpp"
#include "triskin/geometry/routing.hpp"
#include "triskin/model/design.hpp"
#include "triskin/model/module_list.hpp"
#include "triskin/model/patch_joints.hpp"

namespace triskin::test {

/// A random connected set of tiles on the plane, routed: a design without a mesh. Joints are those of the lattice, cycles included.
inline model::Design random_design(int modules, std::mt19937_64& random) {
  using geometry::Tile;
  std::vector<Tile> tiles{{0, 0, true}};
  std::map<Tile, int> number{{tiles[0], 0}};
  while (static_cast<int>(tiles.size()) < modules) {
    const std::size_t from = random() % tiles.size();
    const Tile next = geometry::across(tiles[from], static_cast<int>(random() % 3)).tile;
    if (number.try_emplace(next, static_cast<int>(tiles.size())).second) tiles.push_back(next);
  }
  model::Design d;
  d.name = "random";
  d.source_file = "random.obj";
  d.surface.vertices = {{-2000, -2000, 0}, {2000, -2000, 0}, {2000, 2000, 0}, {-2000, 2000, 0}};
  d.surface.faces = {{0, 1, 2}, {0, 2, 3}};
  d.layout.islands = 1;
  d.layout.method = "surface";
  for (const Tile& t : tiles) {
    geometry::PlacedModule m;
    m.tile = t;
    for (int k = 0; k < 3; ++k) {
      const auto [i, j] = geometry::tile_corner_index(t, k);
      const geometry::Vec2 p = geometry::grid_point(i, j);
      m.corner_mm[static_cast<std::size_t>(k)] = geometry::Vec3{p.x(), p.y(), 0.0};
      const auto other = number.find(geometry::across(t, k).tile);
      m.neighbour[static_cast<std::size_t>(k)] = other == number.end() ? -1 : other->second;
    }
    d.layout.modules.push_back(m);
  }
  d.patches = geometry::route(model::graph_of(d.layout)).patches;
  d.design_id = model::design_id_of(d);
  return d;
}

/// Rows of patch 0 that any tree over its joints can reach without one module: flood fill from the entry.
inline std::uint32_t rows_that_survive(const model::Design& design, int dead_row) {
  const model::PortEnds ends = model::joints_of(design, 0);
  std::uint32_t reached = dead_row == 0 ? 0 : 1;
  for (std::size_t round = 0; round < ends.size(); ++round) {
    for (std::size_t m = 0; m < ends.size(); ++m) {
      if ((reached >> m & 1) == 0) continue;
      for (const model::PortEnd& e : ends[m]) {
        if (e.row >= 0 && e.row != dead_row) reached |= 1U << e.row;
      }
    }
  }
  return reached;
}

}  // namespace triskin::test

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <random>

#include "support/flat_design.hpp"
#include "triskin/design/module_graph.hpp"
#include "triskin/design/tile.hpp"
#include "triskin/lattice/map_modules.hpp"
#include "triskin/routing/jumpers.hpp"
#include "triskin/routing/routing.hpp"

namespace triskin::test {

inline constexpr double kSeam_mm = 5.0;

/// Appends an island of `modules` random connected tiles: rows j ≥ 0 of the lattice (upper), or rows j < 0 moved down
/// by kSeam_mm. Tile (0, 0, up) and tile (0, -1, down) always exist and face each other across the seam.
inline void add_island(design::Design& d, int modules, bool upper, std::mt19937_64& random) {
  using design::Tile;
  const int island = d.layout.islands++, base = static_cast<int>(d.layout.modules.size());
  std::vector<Tile> tiles{upper ? Tile{0, 0, true} : Tile{0, -1, false}};
  std::map<Tile, int> number{{tiles[0], base}};
  while (static_cast<int>(tiles.size()) < modules) {
    const Tile next = design::across(tiles[random() % tiles.size()], static_cast<int>(random() % 3)).tile;
    if ((next.j >= 0) != upper) continue;
    if (number.try_emplace(next, base + static_cast<int>(tiles.size())).second) tiles.push_back(next);
  }
  lay_modules(d, tiles, number, island, {0.0, upper ? 0.0 : -kSeam_mm});
}

/// Makes two islands on the plane with a seam of 5 mm between them, measured, joined by jumpers if that pays, and
/// wired.
inline design::Design jumpered_design(int upper, int lower, std::mt19937_64& random) {
  design::Design d = flat_design("jumpered", {-900, -900}, {900, 900});
  d.layout.islands = 0;
  add_island(d, upper, true, random);
  add_island(d, lower, false, random);
  const mesh::Surface surface(d.surface);
  lattice::measure(surface, d.layout);
  routing::RoutingResult routes =
      routing::route(design::graph_of(d.layout), routing::find_jumpers(surface, d.layout, d.limits));
  d.patches = std::move(routes.patches);
  d.layout.jumpers = std::move(routes.jumpers);
  design::Design::Report& r = d.report;
  r.area_cm2 = surface.area_mm2() / 100.0;
  r.upper_bound = static_cast<int>(surface.area_mm2() / design::kModuleArea_mm2);
  r.coverage = static_cast<double>(d.layout.modules.size()) * design::kModuleArea_mm2 / surface.area_mm2();
  for (const design::PlacedModule& m : d.layout.modules) {
    r.max_edge_error_mm = std::max(r.max_edge_error_mm, m.edge_error_mm);
    r.max_center_gap_mm = std::max(r.max_center_gap_mm, m.center_gap_mm);
    for (const double gap : m.hinge_gap_mm) r.max_hinge_gap_mm = std::max(r.max_hinge_gap_mm, gap);
  }
  r.patches_lower_bound = routes.lower_bound;
  r.jumpers_lower_bound = routes.jumpers_lower_bound;
  d.design_id = design::design_id_of(d);
  return d;
}

}  // namespace triskin::test

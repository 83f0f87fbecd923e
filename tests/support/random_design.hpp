// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <bit>
#include <map>
#include <random>
#include <vector>

#include "support/flat_design.hpp"
#include "triskin/design/joint.hpp"
#include "triskin/design/module_list.hpp"
#include "triskin/design/tile.hpp"
#include "triskin/routing/routing.hpp"

namespace triskin::test {

/// Routes a random connected set of tiles on the plane: a design without a mesh. Joints are those of the lattice,
/// cycles included.
inline design::Design random_design(int modules, std::mt19937_64& random) {
  using design::Tile;
  std::vector<Tile> tiles{{0, 0, true}};
  std::map<Tile, int> number{{tiles[0], 0}};
  while (static_cast<int>(tiles.size()) < modules) {
    const std::size_t from = random() % tiles.size();
    const Tile next = design::across(tiles[from], static_cast<int>(random() % 3)).tile;
    if (number.try_emplace(next, static_cast<int>(tiles.size())).second) tiles.push_back(next);
  }
  design::Design d = flat_design("random", {-2000, -2000}, {2000, 2000});
  lay_modules(d, tiles, number);
  d.patches = routing::route(design::graph_of(d.layout)).patches;
  d.design_id = design::design_id_of(d);
  return d;
}

/// Lists what is broken in patch 0, by row.
struct Broken {
  std::vector<int> dead;
  std::vector<std::pair<int, int>> cut;
};

/// Returns the rows that can be reached from one: flood fill over the surviving joints, one bit per row.
inline std::uint32_t reached_from(int start, const design::PortEnds& ends, const Broken& broken) {
  const auto dead = [&](int m) { return std::ranges::find(broken.dead, m) != broken.dead.end(); };
  const auto cut = [&](int a, int b) {
    return std::ranges::any_of(broken.cut,
                               [&](const auto& c) { return std::minmax(c.first, c.second) == std::minmax(a, b); });
  };
  std::uint32_t reached = dead(start) ? 0 : 1U << start;
  for (std::size_t round = 0; round < ends.size(); ++round) {
    for (int m = 0; m < static_cast<int>(ends.size()); ++m) {
      if ((reached >> m & 1) == 0) continue;
      for (const design::PortEnd& e : ends[static_cast<std::size_t>(m)]) {
        if (e.row >= 0 && !dead(e.row) && !cut(m, e.row)) reached |= 1U << e.row;
      }
    }
  }
  return reached;
}

/// Returns the row with the second cable; -1 if there is none.
inline int second_entry_row(const design::Design& design) {
  const design::Patch& patch = design.patches[0];
  const auto found = std::ranges::find(patch.modules, patch.second_entry, &design::RoutedModule::node);
  return patch.second_entry < 0 || found == patch.modules.end() ? -1 : static_cast<int>(found - patch.modules.begin());
}

/// Returns the rows that the controller can read over one of its cables: the first, unless it reaches nobody, or less
/// than half of the patch and not more than the second.
inline std::uint32_t rows_that_survive(const design::Design& design, const Broken& broken) {
  const design::PortEnds ends = design::joints_of(design, layout::PatchIndex{0});
  const int second_row = second_entry_row(design);
  const std::uint32_t first = reached_from(0, ends, broken),
                      second = second_row < 0 ? 0 : reached_from(second_row, ends, broken);
  const auto little = 2 * static_cast<std::size_t>(std::popcount(first)) < ends.size();
  return first == 0 || (little && std::popcount(second) >= std::popcount(first)) ? second : first;
}

}  // namespace triskin::test

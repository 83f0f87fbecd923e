// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <map>
#include <random>
#include <vector>

#include "support/flat_design.hpp"
#include "triskin/design/tile.hpp"

namespace triskin::test {

/// Makes random patches on the plane z = 0, side by side, `sizes[p]` modules each (1 … 16): every patch is a tree of
/// joined tiles from its entry. Lines and addresses cycle in the order of growth: no router, no mesh.
inline design::Design blob(const std::vector<int>& sizes, std::uint64_t seed) {
  using design::Tile;
  std::mt19937_64 random(seed);
  design::Design d = flat_design("blob", {-2000, -2000}, {2000, 2000});
  std::map<Tile, int> number;
  std::vector<Tile> tiles;
  const auto add = [&](const Tile& t) {
    number.emplace(t, static_cast<int>(tiles.size()));
    tiles.push_back(t);
    return static_cast<int>(tiles.size()) - 1;
  };
  for (const int size : sizes) {
    design::Patch patch;
    Tile first{0, 0, true};
    while (number.contains(first)) {
      const Tile from = tiles[random() % tiles.size()];
      first = design::across(from, static_cast<int>(random() % 3)).tile;
    }
    patch.entry = add(first);
    patch.modules.push_back({patch.entry, -1, 0, 0, 0, 0});
    for (int tries = 0; static_cast<int>(patch.modules.size()) < size && tries < 10'000; ++tries) {
      const design::RoutedModule parent = patch.modules[random() % patch.modules.size()];
      const int side = static_cast<int>(random() % 3);
      const auto next = design::across(tiles[static_cast<std::size_t>(parent.node)], side);
      const bool cable = parent.parent < 0 && side == parent.rotation;  // The entry module's cable occupies this side.
      if (cable || number.contains(next.tile)) continue;
      const int n = static_cast<int>(patch.modules.size());
      patch.modules.push_back({add(next.tile), parent.node, next.side, n % 4, n / 4, parent.depth + 1});
    }
    for (const auto& m : patch.modules) patch.max_depth = std::max(patch.max_depth, m.depth);
    d.patches.push_back(patch);
  }
  lay_modules(d, tiles, number);
  d.design_id = design::design_id_of(d);
  return d;
}

}  // namespace triskin::test

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <utility>
#include <vector>

#include "support/random_design.hpp"
#include "triskin/hardware/scene.hpp"

namespace triskin::test {

/// Makes three rows of tiles with two patches or more with free addresses, whose modules join across the border.
inline design::Design joined_patches(int columns, int capacity, bool second_entry = false) {
  using design::Tile;
  std::vector<Tile> tiles;
  std::map<Tile, int> number;
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < columns; ++i) {
      for (const bool up : {true, false}) {
        number.emplace(Tile{i, j, up}, static_cast<int>(tiles.size()));
        tiles.push_back({i, j, up});
      }
    }
  }
  design::Design d = flat_design("joined", {-2000, -2000}, {2000, 2000});
  lay_modules(d, tiles, number);
  routing::RoutingOptions options;
  options.capacity = capacity;
  options.second_entry = second_entry;
  d.patches = routing::route(design::graph_of(d.layout), options).patches;
  d.design_id = design::design_id_of(d);
  return d;
}

/// A failure of a module that leaves other modules to a neighbour.
struct Unreachable {
  int dead = -1, patch = -1;
  std::vector<int> modules;
};
inline std::vector<Unreachable> unreachable_of(const design::Design& design) {
  std::vector<Unreachable> list;
  for (int p = 0; p < static_cast<int>(design.patches.size()); ++p) {
    for (const design::FailureLoss& f : design.patches[static_cast<std::size_t>(p)].failures) {
      if (f.other_node >= 0 || f.adopted.empty()) continue;
      Unreachable o{f.node, p, {}};
      for (const auto& a : f.adopted) o.modules.push_back(a[0]);
      list.push_back(std::move(o));
    }
  }
  return list;
}

inline hardware::Scene scene_of(const design::Design& design) {
  hardware::Scene s;
  s.design = design;
  s.switched = s.border_joints = true;
  s.effects.taxel_spread_counts = 3000;  // Every taxel of every module has another rest value.
  return s;
}

}  // namespace triskin::test

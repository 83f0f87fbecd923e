// SPDX-License-Identifier: GPL-3.0-or-later
// Gives short names to the parts of the random patches that the routing tests use.
#pragma once
#include <set>

#include "plan/routing/src/random_patch.hpp"
#include "triskin/routing/routing.hpp"

namespace triskin::testing {

using design::Tile;
using routing::random_patch;
using Tiles = std::set<Tile>;
using Shape = routing::PatchShape;
using Listed = routing::LatticePatch;

inline Listed listed(const Tiles& tiles) {
  return routing::lattice_patch(tiles);
}

inline design::Vec2 center(const Tile& t) {
  design::Vec2 sum{0, 0};
  for (int c = 0; c < 3; ++c) {
    const auto v = design::tile_corner_index(t, c);
    sum += design::grid_point(v[0], v[1], 1.0);
  }
  return sum / 3.0;
}

inline int joints(const Tiles& tiles, const Tile& t) {
  int n = 0;
  for (int s = 0; s < 3; ++s) n += tiles.contains(design::across(t, s).tile) ? 1 : 0;
  return n;
}

}  // namespace triskin::testing

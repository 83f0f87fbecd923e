// SPDX-License-Identifier: GPL-3.0-or-later
// Gives short names to the parts of the random patches that the routing tests use.
#pragma once
#include <set>

#include "triskin/routing/random_patch.hpp"
#include "triskin/routing/routing.hpp"

namespace triskin::testing {

using geometry::random_patch;
using geometry::Tile;
using Tiles = std::set<Tile>;
using Shape = geometry::PatchShape;
using Listed = geometry::LatticePatch;

inline Listed listed(const Tiles& tiles) {
  return geometry::lattice_patch(tiles);
}

inline geometry::Vec2 center(const Tile& t) {
  geometry::Vec2 sum{0, 0};
  for (int c = 0; c < 3; ++c) {
    const auto v = geometry::tile_corner_index(t, c);
    sum += geometry::grid_point(v[0], v[1], 1.0);
  }
  return sum / 3.0;
}

inline int joints(const Tiles& tiles, const Tile& t) {
  int n = 0;
  for (int s = 0; s < 3; ++s) n += tiles.contains(geometry::across(t, s).tile) ? 1 : 0;
  return n;
}

}  // namespace triskin::testing

// SPDX-License-Identifier: GPL-3.0-or-later
#include "random_patch.hpp"

#include <cmath>
#include <map>

#include "triskin/base/dice.hpp"

namespace triskin::routing {
namespace {

Vec2 center(const Tile& t) {
  Vec2 sum{0, 0};
  for (int c = 0; c < 3; ++c) {
    const auto v = tile_corner_index(t, c);
    sum += grid_point(v[0], v[1], 1.0);
  }
  return sum / 3.0;
}

int joints(const std::set<Tile>& tiles, const Tile& t) {
  int n = 0;
  for (int s = 0; s < 3; ++s) n += tiles.contains(across(t, s).tile) ? 1 : 0;
  return n;
}

// Grows from one tile; the next tile is the neighbour of least `cost`.
template <class Cost>
std::set<Tile> grow(int n, Cost cost) {
  std::set<Tile> tiles{{0, 0, true}}, rim;
  for (int s = 0; s < 3; ++s) rim.insert(across({0, 0, true}, s).tile);
  while (static_cast<int>(tiles.size()) < n) {
    const Tile* best = nullptr;
    double least = 0.0;
    for (const Tile& t : rim) {
      const double c = cost(t, tiles);
      if (best == nullptr || c < least) {
        best = &t;
        least = c;
      }
    }
    const Tile t = *best;
    rim.erase(t);
    tiles.insert(t);
    for (int s = 0; s < 3; ++s) {
      const Tile u = across(t, s).tile;
      if (!tiles.contains(u)) rim.insert(u);
    }
  }
  return tiles;
}

std::set<Tile> random_tiles(PatchShape shape, int n, std::uint64_t seed) {
  Dice dice(seed);
  const double width = 2.0 + dice.below(4);
  // Each hole is a disc of one to seven tiles that growth avoids.
  std::vector<Vec2> holes;
  if (shape == PatchShape::kHoled) {
    const int radius = 2 + static_cast<int>(std::sqrt(n) / 3);
    for (int k = 0; k < n / 20; ++k)
      holes.push_back({dice.below(2 * radius) - radius + 0.6, dice.below(2 * radius) - radius + 0.3});
  }
  return grow(n, [&](const Tile& t, const std::set<Tile>& tiles) {
    const Vec2 c = center(t);
    const double noise = dice.unit();
    if (shape == PatchShape::kDendritic) return noise + (joints(tiles, t) > 1 ? 0.7 : 0.0);
    if (shape == PatchShape::kStrip)
      return std::abs(c.x()) / 6 + (std::abs(c.y()) > width / 2 ? 1000.0 + std::abs(c.y()) : 0.0) + 0.3 * noise;
    double cost = c.norm() + 0.6 * noise;
    for (const auto& h : holes) cost += (c - h).norm() < 0.9 ? 1000.0 : 0.0;
    return cost;
  });
}

}  // namespace

LatticePatch lattice_patch(const std::set<Tile>& tiles) {
  LatticePatch list{{tiles.begin(), tiles.end()}, {}};
  std::map<Tile, int> index;
  for (std::size_t k = 0; k < list.tiles.size(); ++k) index[list.tiles[k]] = static_cast<int>(k);
  for (const Tile& t : list.tiles) {
    ModuleGraph::Node node;
    for (int s = 0; s < 3; ++s) {
      const auto found = index.find(across(t, s).tile);
      if (found == index.end()) continue;
      node.neighbour[static_cast<std::size_t>(s)] = found->second;
      node.border[static_cast<std::size_t>(s)] = false;
    }
    list.graph.nodes.push_back(node);
  }
  return list;
}

LatticePatch random_patch(PatchShape shape, int n, std::uint64_t seed) {
  return lattice_patch(random_tiles(shape, n, seed));
}

}  // namespace triskin::routing

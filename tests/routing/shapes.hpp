// SPDX-License-Identifier: GPL-3.0-or-later
// Random patches on the lattice, equal on every compiler.
#pragma once
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "triskin/geometry/lattice.hpp"
#include "triskin/geometry/routing.hpp"

namespace triskin::testing {

using geometry::Tile;
using Tiles = std::set<Tile>;
enum class Shape { kCompact, kStrip, kHoled, kDendritic };

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

 private:
  std::mt19937_64 engine_;
};

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

// Grows from one tile; the next is the one of least `cost` among those beside it.
template <class Cost>
Tiles grow(int n, Cost cost) {
  Tiles tiles{{0, 0, true}}, rim;
  for (int s = 0; s < 3; ++s) rim.insert(geometry::across({0, 0, true}, s).tile);
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
      const Tile u = geometry::across(t, s).tile;
      if (!tiles.contains(u)) rim.insert(u);
    }
  }
  return tiles;
}

inline Tiles random_tiles(Shape shape, int n, std::uint64_t seed) {
  Dice dice(seed);
  const double width = 2.0 + dice.below(4);
  // Holes: discs of one to seven tiles that growth avoids.
  std::vector<geometry::Vec2> holes;
  if (shape == Shape::kHoled) {
    const int radius = 2 + static_cast<int>(std::sqrt(n) / 3);
    for (int k = 0; k < n / 20; ++k) holes.push_back({dice.below(2 * radius) - radius + 0.6, dice.below(2 * radius) - radius + 0.3});
  }
  return grow(n, [&](const Tile& t, const Tiles& tiles) {
    const geometry::Vec2 c = center(t);
    const double noise = dice.unit();
    if (shape == Shape::kDendritic) return noise + (joints(tiles, t) > 1 ? 0.7 : 0.0);
    if (shape == Shape::kStrip) return std::abs(c.x()) / 6 + (std::abs(c.y()) > width / 2 ? 1000.0 + std::abs(c.y()) : 0.0) + 0.3 * noise;
    double cost = c.norm() + 0.6 * noise;
    for (const auto& h : holes) cost += (c - h).norm() < 0.9 ? 1000.0 : 0.0;
    return cost;
  });
}

struct Listed {
  std::vector<Tile> tiles;
  geometry::ModuleGraph graph;
};
inline Listed listed(const Tiles& tiles) {
  Listed list{{tiles.begin(), tiles.end()}, {}};
  std::map<Tile, int> index;
  for (std::size_t k = 0; k < list.tiles.size(); ++k) index[list.tiles[k]] = static_cast<int>(k);
  for (const Tile& t : list.tiles) {
    geometry::ModuleGraph::Node node;
    for (int s = 0; s < 3; ++s) {
      const auto found = index.find(geometry::across(t, s).tile);
      if (found == index.end()) continue;
      node.neighbour[static_cast<std::size_t>(s)] = found->second;
      node.border[static_cast<std::size_t>(s)] = false;
    }
    list.graph.nodes.push_back(node);
  }
  return list;
}
inline Listed random_patch(Shape shape, int n, std::uint64_t seed) { return listed(random_tiles(shape, n, seed)); }

}  // namespace triskin::testing

// SPDX-License-Identifier: GPL-3.0-or-later
// Outlines that are exact unions of tiles hold exactly these, because their area allows no more.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "polygons.hpp"
#include "triskin/placement/placement.hpp"

namespace triskin::placement {
namespace {

constexpr int kUnions = 150;  // Ten thousand were run once (docs/measurements/placement.md).

using Node = std::array<int, 2>;

// Grows a connected set of tiles, tile by tile.
std::set<Tile> random_union(std::mt19937_64& random, std::size_t tiles) {
  std::set<Tile> set{{0, 0, true}};
  while (set.size() < tiles) {
    auto at = set.begin();
    std::advance(at, static_cast<std::ptrdiff_t>(random() % set.size()));
    set.insert(across(*at, static_cast<int>(random() % 3)).tile);
  }
  return set;
}

// Returns sides that belong to one tile only, each from node to node with the tile on its left; none if a node has two
// (the outline would touch itself).
std::map<Node, Node> outline_of(const std::set<Tile>& tiles) {
  std::map<Node, Node> next;
  for (const Tile& t : tiles) {
    for (int k = 0; k < 3; ++k) {
      const auto a = tile_corner_index(t, k), b = tile_corner_index(t, (k + 1) % 3);
      const bool shared = std::ranges::any_of(tiles, [&](const Tile& other) {
        if (other == t) return false;
        int common = 0;
        for (int m = 0; m < 3; ++m) {
          const auto c = tile_corner_index(other, m);
          common += (c == a ? 1 : 0) + (c == b ? 1 : 0);
        }
        return common == 2;
      });
      if (!shared && !next.emplace(Node{a[0], a[1]}, Node{b[0], b[1]}).second) return {};
    }
  }
  return next;
}

// Returns its single ring; empty when there are holes too.
std::vector<Vec2> ring_of(const std::map<Node, Node>& next) {
  std::vector<Vec2> ring;
  if (next.empty()) return ring;
  Node at = next.begin()->first;
  do {
    ring.push_back(grid_point(at[0], at[1]));
    at = next.at(at);
  } while (at != next.begin()->first);
  if (ring.size() != next.size()) ring.clear();
  return ring;
}

TEST(ExactUnion, holds_just_its_tiles_at_any_motion) {
  std::mt19937_64 random(5);
  for (int k = 0; k < kUnions;) {
    const std::set<Tile> tiles = random_union(random, 1 + random() % 24);
    Polygon p;
    p.outer = ring_of(outline_of(tiles));
    if (p.outer.empty()) continue;
    ++k;
    PlacementOptions options;
    options.tolerance_mm = std::pow(10.0, test::uniform(random, -8.0, -6.0));
    p = test::moved(p, test::uniform(random, 0.0, 7.0),
                    {test::uniform(random, -300.0, 300.0), test::uniform(random, -300.0, 300.0)});
    SCOPED_TRACE(fmt::format("union {} of {} tiles, tolerance {} mm", k, tiles.size(), options.tolerance_mm));
    const PlacementResult r = place(p, options);
    EXPECT_EQ(r.modules, static_cast<int>(tiles.size()));
    EXPECT_TRUE(r.proved);
    EXPECT_GE(r.clearance_mm, -options.tolerance_mm);
    EXPECT_EQ(r.tiles.size(), tiles.size());
  }
}

// The largest clearance once began below the inset that was proved, and the exact check found a tile cut by an edge.
TEST(ExactUnion, the_clearance_never_falls_below_the_tolerance) {
  Polygon p;
  p.outer = {{-32.35110473187949, 9.012961130129602},
             {-2.5525134058511867, 5.542520958573462},
             {15.35227160804461, 29.613637958126525},
             {-44.24491104401199, 36.55451830123881}};
  PlacementOptions options;
  options.tolerance_mm = 1e-8;
  const PlacementResult r = place(p, options);
  EXPECT_EQ(r.modules, 3);
  EXPECT_TRUE(r.proved);
  EXPECT_GE(r.clearance_mm, -1e-8);
}

// At the smallest tolerance the motions that hold both are a box of some nanometres, 3 m from the origin.
TEST(ExactUnion, is_found_at_the_smallest_tolerance) {
  Polygon p;
  p.outer = {{1461.9661338143164, -2929.0034944407007},
             {1482.2840933812636, -2872.548374929394},
             {1423.2335459273122, -2883.180065547006}};
  PlacementOptions options;
  options.tolerance_mm = 1.0062979374699537e-08;
  const PlacementResult r = place(p, options);
  EXPECT_EQ(r.modules, 4);  // It is an equilateral triangle with sides of 60 mm.
  EXPECT_TRUE(r.proved);
}

}  // namespace
}  // namespace triskin::placement

// SPDX-License-Identifier: GPL-3.0-or-later
// Lists of waiting cells are packed when they take much memory; opened again they have the same tiles.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "kernels/tile_grid.hpp"
#include "search/branch_and_bound.hpp"
#include "search/cell_list.hpp"

namespace triskin::placement {
namespace {

TEST(PackedTiles, have_the_tiles_of_the_list_in_eight_bytes_each) {
  const TileGrid grid = tile_grid(TileShape::kTriangle, 0.0);
  CellList list;
  for (const Tile& tile : {Tile{0, 0, true}, Tile{-7, 3, false}, Tile{2000, -1999, true}, Tile{-1, -1, false}}) {
    for (const bool inside : {false, true}) list.tiles.push_back({grid.center(tile), tile, inside, 0, 0});
  }
  const PackedTiles packed(list);
  EXPECT_EQ(packed.bytes(), 8 * list.tiles.size());
  const auto again = packed.unpacked(grid);
  ASSERT_EQ(again->tiles.size(), list.tiles.size());
  for (std::size_t k = 0; k < list.tiles.size(); ++k) {
    EXPECT_EQ(again->tiles[k].tile, list.tiles[k].tile);
    EXPECT_EQ(again->tiles[k].inside, list.tiles[k].inside);
    EXPECT_EQ(again->tiles[k].center, list.tiles[k].center);
    EXPECT_EQ(again->tiles[k].count, 0U);
  }
}

// A search whose cells are all packed finds and proves the same.
TEST(PackedTiles, do_not_change_what_is_found) {
  const TileGrid grid = tile_grid(TileShape::kTriangle, 0.0);
  std::mt19937_64 random(20261128);
  std::uniform_real_distribution<double> radius(90.0, 150.0);
  for (int outline = 0; outline < 6; ++outline) {
    Polygon polygon;
    for (int k = 0; k < 40; ++k) {
      const double r = radius(random), angle = 2.0 * std::numbers::pi * k / 40;
      polygon.outer.emplace_back(r * std::cos(angle), r * std::sin(angle));
    }
    const PreparedPolygon prepared = prepare(polygon);
    SearchGoal goal;
    goal.threads = 1;
    const SearchResult whole = branch_and_bound(prepared, grid, goal);
    goal.unpacked_bytes = 0.0;
    const SearchResult packed = branch_and_bound(prepared, grid, goal);
    EXPECT_EQ(whole.best, whole.upper_bound) << outline;
    EXPECT_EQ(packed.best, whole.best) << outline;
    EXPECT_EQ(packed.upper_bound, whole.upper_bound) << outline;
  }
}

}  // namespace
}  // namespace triskin::placement

// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the evaluation of a placement with holes with brute force in exact arithmetic, tile by tile.
#include <gtest/gtest.h>

#include <algorithm>

#include "exact_count.hpp"
#include "polygons.hpp"
#include "triskin/placement/placement.hpp"

namespace triskin::placement {
namespace {

TEST(TilesInside, equals_brute_force_on_2000_placements_of_10_polygons_with_holes) {
  constexpr std::uint64_t kSeed = 20130101;
  std::mt19937_64 random(kSeed);
  int with_modules = 0;
  for (int polygon = 0; polygon < 10; ++polygon) {
    const Polygon p = test::random_polygon(random, 8 + 4 * polygon, 40.0 + 12.0 * polygon, polygon % 4);
    for (int k = 0; k < 200; ++k) {
      const Placement at{test::uniform(random, -100, 100), test::uniform(random, -100, 100),
                         test::uniform(random, -4, 4)};
      const auto tiles = tiles_inside(p, at, 0.0);
      ASSERT_EQ(tiles, test::ExactCount(p, at).tiles())
          << "seed " << kSeed << " polygon " << polygon << " placement " << k;
      with_modules += tiles.empty() ? 0 : 1;
    }
  }
  EXPECT_GT(with_modules, 1800);
}

// Three sides that do not cross the polygon would accept it.
TEST(TilesInside, a_hole_inside_one_tile_removes_that_tile) {
  Polygon p;
  p.outer = {{-100, -100}, {100, -100}, {100, 100}, {-100, 100}};
  const Placement at{};
  const std::size_t without = tiles_inside(normalize_polygon(p, "square"), at, 0.0).size();
  p.holes = {{{14, 8}, {16, 8}, {15, 10}}};  // The hole lies around the centre (15, 8.66) of the up tile (0, 0).
  const auto with = tiles_inside(normalize_polygon(p, "square"), at, 0.0);
  EXPECT_EQ(with.size(), without - 1);
  EXPECT_EQ(std::ranges::count(with, Tile{0, 0, true}), 0);
}

}  // namespace
}  // namespace triskin::placement

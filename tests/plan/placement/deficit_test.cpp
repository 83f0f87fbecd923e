// SPDX-License-Identifier: GPL-3.0-or-later
// Tests how far the sides of modules must be drawn in until one module more fits.
#include <gtest/gtest.h>

#include "polygons.hpp"
#include "triskin/placement/placement.hpp"

namespace triskin::placement {
namespace {

constexpr double kWidth = 0.02;  // The interval around the answer has this relative width.

PlacementResult with_deficit(const Polygon& p) {
  PlacementOptions options;
  options.largest_clearance = false;
  options.deficit = true;
  return place(p, options);
}

Polygon triangle_of_side(double side_mm) {
  Polygon p;
  p.outer = {{0, 0}, {side_mm, 0}, {side_mm / 2, side_mm * kHeight_mm / kSide_mm}};
  return test::moved(p, 0.7, {40, 900});
}

TEST(Deficit, triangles_smaller_than_a_module_lack_the_difference_of_inradii) {
  for (const double side_mm : {29.0, 26.0, 20.0}) {
    const PlacementResult r = with_deficit(triangle_of_side(side_mm));
    const double lacking = (kSide_mm - side_mm) / (2.0 * std::sqrt(3.0));
    ASSERT_EQ(r.modules, 0);
    ASSERT_TRUE(r.deficit_mm);
    EXPECT_NEAR(*r.deficit_mm, lacking, kWidth * lacking + 5e-3) << side_mm;
    EXPECT_GE(*r.deficit_mm, lacking - 1e-6);
    EXPECT_LE(r.deficit_bound_mm, lacking + 1e-6);
  }
}

// If the sides of a module have moved in so far that it fits here, nothing of it remains.
TEST(Deficit, what_no_giving_way_mends_has_none) {
  const PlacementResult r = with_deficit(triangle_of_side(2.0));
  EXPECT_EQ(r.modules, 0);
  EXPECT_FALSE(r.deficit_mm);
}

TEST(Deficit, one_more_fits_there_and_random_motions_find_none_below_the_bound) {
  std::mt19937_64 random(41);
  for (int k = 0; k < 6; ++k) {
    const Polygon p = test::random_polygon(random, 16, 70, k % 2);
    const PlacementResult r = with_deficit(p);
    ASSERT_TRUE(r.proved);
    ASSERT_TRUE(r.deficit_mm);
    EXPECT_LE(r.deficit_bound_mm, *r.deficit_mm);
    EXPECT_GE(r.deficit_bound_mm, *r.deficit_mm - std::max(5e-3, kWidth * *r.deficit_mm) - 1e-9);
    EXPECT_GT(tiles_inside(p, r.deficit_placement, *r.deficit_mm + 1e-6).size(), static_cast<std::size_t>(r.modules));
    for (int n = 0; n < 3000; ++n) {
      const Placement at{test::uniform(random, 0, kSide_mm), test::uniform(random, 0, kHeight_mm),
                         test::uniform(random, 0, M_PI / 3)};
      EXPECT_LE(tiles_inside(p, at, r.deficit_bound_mm - 1e-9).size(), static_cast<std::size_t>(r.modules));
    }
  }
}

}  // namespace
}  // namespace triskin::placement

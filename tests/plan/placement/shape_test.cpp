// SPDX-License-Identifier: GPL-3.0-or-later
// Tests other module shapes and gaps: the same search, with values worked by hand.
#include <gtest/gtest.h>

#include "polygons.hpp"
#include "triskin/base/error.hpp"
#include "triskin/placement/placement.hpp"

namespace triskin::placement {
namespace {

PlacementResult best(const Polygon& p, TileShape shape, double gap_mm = 0.0) {
  PlacementOptions options;
  options.shape = shape;
  options.gap_mm = gap_mm;
  options.largest_clearance = false;
  return place(p, options);
}

Polygon rectangle(double width, double height, double angle = 0.3) {
  Polygon p;
  p.outer = {{0, 0}, {width, 0}, {width, height}, {0, height}};
  return test::moved(p, angle, {5, -3});
}

TEST(Shapes, squares_fill_a_rectangle) {
  EXPECT_EQ(best(rectangle(150.01, 90.01), TileShape::kSquare).modules, 15);
  EXPECT_EQ(best(rectangle(149.0, 90.01), TileShape::kSquare).modules, 12);
  EXPECT_TRUE(best(rectangle(149.0, 89.0), TileShape::kSquare).proved);
}

TEST(Shapes, a_gap_between_squares_widens_the_pitch_by_itself) {
  // A row has n modules and n − 1 gaps.
  EXPECT_EQ(best(rectangle(158.01, 62.01), TileShape::kSquare, 2.0).modules, 10);
  EXPECT_EQ(best(rectangle(157.9, 62.01), TileShape::kSquare, 2.0).modules, 8);
}

TEST(Shapes, a_row_of_hexagons_is_as_long_as_their_widths) {
  const double width = 30.0 * std::sqrt(3.0);
  EXPECT_EQ(best(rectangle(3 * width + 0.01, 60.01), TileShape::kHexagon).modules, 3);
  // The outline is too low for that, but turned by 30°, every second column still fits (60 + 90 mm long, 52 mm high).
  EXPECT_EQ(best(rectangle(3 * width + 0.01, 59.9), TileShape::kHexagon).modules, 2);
  EXPECT_EQ(best(rectangle(3 * width + 0.01, 51.9), TileShape::kHexagon).modules, 0);
}

TEST(Shapes, facing_triangles_stand_apart_by_the_gap) {
  // An up and a down triangle across a common side, moved apart by 2 mm along its normal (√3, 1) mm, fill this
  // rhombus.
  const double grow = 2.0 / std::sqrt(3.0), height = kHeight_mm + 1.0;
  Polygon rhombus;
  rhombus.outer = {
      {0, 0}, {30 + grow, 0}, {30 + grow + height / std::sqrt(3.0), height}, {height / std::sqrt(3.0), height}};
  EXPECT_EQ(best(rhombus, TileShape::kTriangle, 1.99).modules, 2);
  EXPECT_EQ(best(rhombus, TileShape::kTriangle, 2.1).modules, 1);
}

TEST(Shapes, bad_wishes_are_errors) {
  PlacementOptions options;
  options.shape = TileShape::kSquare;
  options.gap_mm = -1.0;
  EXPECT_THROW((void)place(rectangle(100, 100), options), InputError);
  EXPECT_THROW((void)place(rectangle(1e6, 1e6), {}), InputError);
}

}  // namespace
}  // namespace triskin::placement

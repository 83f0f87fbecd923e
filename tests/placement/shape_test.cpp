// SPDX-License-Identifier: GPL-3.0-or-later
// Other module shapes, gaps: the same search, hand-worked values.
#include <gtest/gtest.h>

#include "polygons.hpp"
#include "triskin/geometry/placement.hpp"
#include "triskin/host/error.hpp"

namespace triskin::geometry {
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
  // n modules and n − 1 gaps in a row.
  EXPECT_EQ(best(rectangle(158.01, 62.01), TileShape::kSquare, 2.0).modules, 10);
  EXPECT_EQ(best(rectangle(157.9, 62.01), TileShape::kSquare, 2.0).modules, 8);
}

TEST(Shapes, a_row_of_hexagons_is_as_long_as_their_widths) {
  const double width = 30.0 * std::sqrt(3.0);
  EXPECT_EQ(best(rectangle(3 * width + 0.01, 60.01), TileShape::kHexagon).modules, 3);
  EXPECT_EQ(best(rectangle(3 * width + 0.01, 59.9), TileShape::kHexagon).modules, 0);
}

TEST(Shapes, facing_triangles_stand_apart_by_the_gap) {
  // Two triangles on a rhombus: apart by the gap across their common side.
  const double gap = 1.0, grow = gap / std::sqrt(3.0);
  Polygon rhombus;
  rhombus.outer = {{0, 0}, {30 + 2 * grow, 0}, {45 + 3 * grow, kHeight_mm + gap + 1e-3}, {15 + grow, kHeight_mm + gap + 1e-3}};
  EXPECT_LE(best(rhombus, TileShape::kTriangle, 2.0).modules, 1);
  EXPECT_EQ(best(rhombus, TileShape::kTriangle, 0.0).modules, 2);
}

TEST(Shapes, bad_wishes_are_errors) {
  PlacementOptions options;
  options.shape = TileShape::kSquare;
  options.keep_proof = true;
  EXPECT_THROW((void)place(rectangle(100, 100), options), InputError);
  EXPECT_THROW((void)place(rectangle(1e6, 1e6), {}), InputError);
}

}  // namespace
}  // namespace triskin::geometry

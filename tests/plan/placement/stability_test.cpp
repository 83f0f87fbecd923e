// SPDX-License-Identifier: GPL-3.0-or-later
// Places numerically awkward polygons: the value is known, and the search must find and prove it.
#include <gtest/gtest.h>

#include "polygons.hpp"
#include "triskin/base/error.hpp"
#include "triskin/placement/placement.hpp"

namespace triskin::placement {
namespace {

PlacementResult certified(const Polygon& p, double tolerance_mm = 1e-6) {
  PlacementOptions options;
  options.tolerance_mm = tolerance_mm;
  options.largest_clearance = false;
  options.time_limit_s = 0.0;  // None, so that a busy machine decides nothing.
  return place(p, options);
}

void expect_value(const Polygon& p, int modules, const char* what, double tolerance_mm = 1e-6) {
  const PlacementResult r = certified(p, tolerance_mm);
  EXPECT_EQ(r.modules, modules) << what;
  EXPECT_TRUE(r.proved) << what << ", bound " << r.upper_bound;
}

Polygon triangle(double side) {
  Polygon p;
  p.outer = {{0, 0}, {side, 0}, {side / 2, side * std::sqrt(0.75)}};
  return p;
}

TEST(Stability, unions_of_tiles_far_away_turned_by_a_hair_mirrored_and_at_every_tolerance) {
  for (const double angle : {0.0, 1e-9, -1e-9, 0.123456789, 1.0, 2.5}) {
    expect_value(test::moved(triangle(120), angle, {1e6, -1e6}), 16, "far away", 1e-6);
    expect_value(test::moved(triangle(120), angle, {3, 4}, true), 16, "mirrored");
  }
  for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-8})
    expect_value(test::moved(triangle(90), 0.7, {1, 2}), 9, "tolerance", tolerance);
}

TEST(Stability, collinear_and_repeated_vertices_change_nothing) {
  Polygon p = triangle(90);
  std::vector<Vec2> dense;
  for (std::size_t k = 0; k < 3; ++k) {
    for (int s = 0; s < 300; ++s) {
      dense.push_back(p.outer[k] + s / 300.0 * (p.outer[(k + 1) % 3] - p.outer[k]));
      if (s % 50 == 0) dense.push_back(dense.back());
    }
  }
  p.outer = dense;
  expect_value(p, 9, "900 collinear vertices", 1e-5);
}

TEST(Stability, a_needle_costs_what_it_touches_and_a_crack_cuts) {
  Polygon needle = triangle(60);  // A spike of 1 µm points out of the middle of the base.
  needle.outer.insert(needle.outer.begin() + 1, {{30, 0}, {30.0005, -40}, {30.001, 0}});
  expect_value(needle, 4, "needle outwards");
  Polygon crack;  // A strip of two rows is cut by a crack of zero width along its middle.
  crack.outer = {{0, 0}, {90.001, 0}, {90.001, 52}, {45, 52}, {45, 1}, {45, 52}, {0, 52}};
  const int whole = certified(test::moved(
                                  [] {
                                    Polygon p;
                                    p.outer = {{0, 0}, {90.001, 0}, {90.001, 52}, {0, 52}};
                                    return p;
                                  }(),
                                  0, {0, 0}))
                        .modules;
  EXPECT_LT(certified(crack).modules, whole);
}

TEST(Stability, scaled_polygons) {
  Polygon small = triangle(90);
  for (Vec2& v : small.outer) v *= 1e-3;
  expect_value(small, 0, "a thousandth of its size");
  Polygon large = triangle(90);
  for (Vec2& v : large.outer) v *= 1e3;
  EXPECT_THROW((void)certified(large), InputError);  // The area is 3,500 m².
  expect_value(triangle(1e-6), 0, "a nanometre");
}

// A hexagon of 24 tiles has the radius 60 mm; in a slightly smaller disc six of its corners do not fit.
TEST(Stability, a_disc_that_misses_a_pattern_by_a_hair) {
  for (const double missing_mm : {0.3, 0.03, 0.003}) {
    Polygon disc;
    for (int k = 0; k < 361; ++k)
      disc.outer.push_back((60.0 - missing_mm) * Vec2(std::cos(2 * M_PI * k / 361), std::sin(2 * M_PI * k / 361)));
    expect_value(disc, 18, "disc");
  }
}

TEST(Stability, near_vertices_follow_the_tolerance) {
  Polygon p = triangle(60);
  p.outer[2].y() -= 1e-7;  // The outline is slightly too low for the upper tile.
  EXPECT_EQ(certified(p, 1e-6).modules, 4);
  EXPECT_LT(certified(p, 1e-8).modules, 4);
}

// Half the tolerance is left for the search, so the pose of the outline decides nothing.
TEST(Stability, a_vertex_too_low_by_less_than_half_the_tolerance_costs_nothing_in_any_pose) {
  std::mt19937_64 random(71);
  for (const double tolerance_mm : {1e-2, 1e-4, 1e-6}) {
    Polygon p = triangle(60);
    p.outer[2].y() -= 0.4 * tolerance_mm;
    for (int k = 0; k < 30; ++k) {
      const double angle = test::uniform(random, 0, 6);
      const Vec2 by(test::uniform(random, -50, 50), test::uniform(random, -50, 50));
      expect_value(test::moved(p, angle, by), 4, "lowered", tolerance_mm);
    }
  }
}

}  // namespace
}  // namespace triskin::placement

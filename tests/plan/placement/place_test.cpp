// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "polygons.hpp"
#include "scans.hpp"
#include "triskin/base/error.hpp"
#include "triskin/placement/placement.hpp"

namespace triskin::placement {
namespace {

PlacementResult certified(const Polygon& p, double tolerance_mm = 1e-6) {
  PlacementOptions options;
  options.tolerance_mm = tolerance_mm;
  options.time_limit_s = 60;
  options.largest_clearance = false;
  return place(p, options);
}

Polygon triangle_of(int n, double angle = 0.0, const Vec2& by = {0, 0}) {
  Polygon p;
  p.outer = {{0, 0}, {n * kSide_mm, 0}, {n * kSide_mm / 2, n * kHeight_mm}};
  return test::moved(p, angle, by);
}

TEST(Place, one_module_fits_its_own_outline_at_any_angle) {
  for (const double angle : {0.0, 1e-9, 0.3, 1.0, 2.7}) {
    const PlacementResult r = certified(triangle_of(1, angle));
    EXPECT_EQ(r.modules, 1) << angle;
    EXPECT_TRUE(r.proved);
  }
}

TEST(Place, a_triangle_of_side_n_holds_n_squared_modules) {
  for (int n = 2; n <= 5; ++n) {
    const PlacementResult r = certified(triangle_of(n, 0.4, {11, -7}));
    EXPECT_EQ(r.modules, n * n);
    EXPECT_EQ(r.upper_bound, n * n);
  }
}

TEST(Place, nothing_fits_and_that_is_proved) {
  Polygon p;
  p.outer = {{0, 0}, {500, 0}, {500, 20}, {0, 20}};  // The strip is lower than a module.
  const PlacementResult r = certified(p);
  EXPECT_EQ(r.modules, 0);
  EXPECT_TRUE(r.proved);
  EXPECT_TRUE(r.tiles.empty());
}

TEST(Place, a_row_of_height_h_holds_what_the_length_gives) {
  // In a strip one module high and L long, up and down alternate, and each further half side adds one.
  Polygon p;
  p.outer = {{0, 0}, {150, 0}, {150, kHeight_mm + 1e-3}, {0, kHeight_mm + 1e-3}};
  EXPECT_EQ(certified(p).modules, 9);  // The number is (150 − 30) / 15 + 1.
}

// The first slices get their bounds however short the time is, and a value is sought among them.
TEST(Place, a_search_without_time_returns_a_placement) {
  std::mt19937_64 random(8);
  const Polygon p = test::random_polygon(random, 40, 2000, 0);
  PlacementOptions options;
  options.time_limit_s = 1e-9;
  options.largest_clearance = false;
  const PlacementResult r = place(p, options);
  EXPECT_GT(r.modules, 300);
  EXPECT_EQ(static_cast<int>(r.tiles.size()), r.modules);
  EXPECT_LT(r.modules, r.upper_bound);
  EXPECT_FALSE(r.proved);
}

TEST(Place, result_is_a_placement_that_holds_the_tiles) {
  std::mt19937_64 random(7);
  for (int k = 0; k < 20; ++k) {
    const Polygon p = test::random_polygon(random, 20, 150, k % 3);
    const PlacementResult r = certified(p);
    EXPECT_TRUE(r.proved);
    EXPECT_EQ(tiles_inside(p, r.placement, 2e-6).size(), static_cast<std::size_t>(r.modules));
    EXPECT_EQ(r.tiles.size(), static_cast<std::size_t>(r.modules));
  }
}

TEST(Place, no_heuristic_beats_the_certified_value_and_none_exceeds_its_bound) {
  std::mt19937_64 random(11);
  for (int k = 0; k < 6; ++k) {
    const Polygon p = test::random_polygon(random, 16, 90, k % 2);
    const PlacementResult best = certified(p);
    ASSERT_TRUE(best.proved);
    for (const auto method : {PlacementMethod::kR1, PlacementMethod::kR2, PlacementMethod::kR3, PlacementMethod::kR4,
                              PlacementMethod::kR5, PlacementMethod::kR6, PlacementMethod::kR7}) {
      PlacementOptions options;
      options.method = method;
      const PlacementResult r = place(p, options);
      EXPECT_LE(r.modules, best.modules);
      EXPECT_LE(r.modules, r.upper_bound);
      EXPECT_GE(r.modules, 0);
    }
    EXPECT_LE(test::most_by_scan(p, 0.0, 11), best.modules);
  }
}

TEST(Place, motion_mirror_and_renumbering_do_not_change_the_value) {
  std::mt19937_64 random(13);
  for (int k = 0; k < 5; ++k) {
    const Polygon p = test::random_polygon(random, 14, 100, 1);
    const int value = certified(p).modules;
    EXPECT_EQ(certified(test::moved(p, 1.1, {1e6, -1e6})).modules, value);
    EXPECT_EQ(certified(test::moved(p, 0.7, {3, 4}, true)).modules, value);
    Polygon turned = p;
    std::ranges::rotate(turned.outer, turned.outer.begin() + 5);
    EXPECT_EQ(certified(turned).modules, value);
  }
}

TEST(Place, clearance_is_positive_for_a_generic_polygon_and_holds) {
  std::mt19937_64 random(17);
  const Polygon p = test::random_polygon(random, 20, 120, 0);
  PlacementOptions options;
  const PlacementResult r = place(p, options);
  EXPECT_TRUE(r.proved);
  EXPECT_GT(r.clearance_mm, 0.0);
  EXPECT_EQ(tiles_inside(p, r.placement, -0.9 * r.clearance_mm).size(), static_cast<std::size_t>(r.modules));
}

TEST(Place, the_search_is_the_same_for_any_number_of_threads) {
  std::mt19937_64 random(19);
  for (int k = 0; k < 4; ++k) {
    const Polygon p = test::random_polygon(random, 30, 200, k % 2);
    PlacementOptions options;
    options.threads = 1;
    const PlacementResult one = place(p, options);
    options.threads = 3;
    const PlacementResult three = place(p, options);
    EXPECT_EQ(three.modules, one.modules);
    EXPECT_EQ(three.upper_bound, one.upper_bound);
    EXPECT_EQ(three.cells, one.cells);
    EXPECT_EQ(three.clearance_mm, one.clearance_mm);
    EXPECT_EQ(three.placement.x_mm, one.placement.x_mm);
    EXPECT_EQ(three.placement.theta_rad, one.placement.theta_rad);
  }
}

TEST(Place, clearance_and_its_bound_are_close) {
  std::mt19937_64 random(23);
  for (int k = 0; k < 5; ++k) {
    const PlacementResult r = place(test::random_polygon(random, 24, 100, 0));
    EXPECT_GE(r.clearance_bound_mm, r.clearance_mm);
    EXPECT_LE(r.clearance_bound_mm, r.clearance_mm + std::max(5e-3, 0.02 * r.clearance_mm) + 1e-9);
  }
}

TEST(Place, a_gap_between_modules_costs_modules) {
  PlacementOptions options;
  options.gap_mm = 2.0;
  options.largest_clearance = false;
  EXPECT_EQ(place(triangle_of(1), options).modules, 1);
  EXPECT_LT(place(triangle_of(3), options).modules, 9);
}

TEST(PlaceInput, names_ring_and_vertex) {
  const auto message = [](const std::string& text) -> std::string {
    try {
      (void)parse_polygon(text, "in.json");
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_EQ(message("POLYGON ((0 0, 10 0, 5 9, 0 0))"), "");
  EXPECT_TRUE(has(message("POLYGON ((0 0, 10 0, 5 9))"), "outer ring"));
  EXPECT_TRUE(has(message("POLYGON ((0 0, 10 0, 5 9, 1 1))"), "vertex 3: the ring is open"));
  EXPECT_TRUE(has(message("POLYGON ((0 0, 10 10, 10 0, 0 10, 0 0))"), "crosses"));
  EXPECT_TRUE(has(message("POLYGON ((0 0, nan 0, 5 9, 0 0))"), "vertex 1"));
  EXPECT_TRUE(has(message("POLYGON ((0 0, 1 0, 2 0, 0 0))"), "traced twice"));
  EXPECT_TRUE(has(message("POLYGON ((0 0, 10 0, 5 9, 0 0), (20 20, 21 20, 20 21, 20 20))"), "hole 0 lies outside"));
  EXPECT_TRUE(has(message("{\"type\":\"Point\",\"coordinates\":[1,2]}"), "Polygon"));
  EXPECT_TRUE(has(message("{\"type\":\"Polygon\",\"coordinates\":[[[0,0],[1,\"x\"],[1,1],[0,0]]]}"), "vertex 1"));
  EXPECT_TRUE(has(message(""), "empty"));
  EXPECT_TRUE(has(message("{"), "JSON"));
}

}  // namespace
}  // namespace triskin::placement

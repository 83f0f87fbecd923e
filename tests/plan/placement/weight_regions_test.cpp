// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the worth by region less the weight of a module: the map at points whose worth is known, and its effect on a
// placement.
#include "plan/placement/src/weight_regions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <numeric>

#include "polygons.hpp"
#include "triskin/base/error.hpp"
#include "triskin/placement/placement.hpp"

namespace triskin::placement {
namespace {

std::vector<Vec2> box(double x0, double y0, double x1, double y1) {
  return {{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}};
}

WeightRegions two_regions() {
  WeightRegions w;
  w.regions = {{box(0, 0, 100, 100), 3.0}, {box(50, 0, 100, 100), 5.0}};
  w.elsewhere = 1.0;
  w.module_weight = 0.5;
  return w;
}

TEST(WeightRegions, worth_is_that_of_the_last_region_less_the_weight_of_the_module) {
  const WeightMap map = weight_map_of(two_regions());
  EXPECT_NEAR(map.at({25, 50}).value, 2.5, 1e-12);
  EXPECT_NEAR(map.at({75, 50}).value, 4.5, 1e-12);
  EXPECT_NEAR(map.at({-400, 50}).value, 0.5, 1e-12);
  EXPECT_NEAR(map.at({50, 900}).value, 0.5, 1e-12);
  WeightRegions heavy = two_regions();
  heavy.module_weight = 3.5;
  // The value is not negative, because such a module is not built.
  EXPECT_EQ(weight_map_of(heavy).at({25, 50}).value, 0.0);
  EXPECT_NEAR(weight_map_of(heavy).at({75, 50}).value, 1.5, 1e-12);
}

// The strip is just wide enough for one row, and contact is likely at its right end alone. Without weights the modules
// may lie anywhere in it; with them each lies as far right as it can.
TEST(WeightRegions, likely_contact_decides_where_modules_lie) {
  Polygon strip;
  strip.outer = box(0, 0, 100, 26.2);
  PlacementOptions options;
  WeightRegions w;
  w.regions = {{box(50, -50, 150, 80), 10.0}};
  w.elsewhere = 0.1;
  w.module_weight = 1.0;
  options.weights = std::make_shared<const WeightMap>(weight_map_of(w));
  const PlacementResult r = place(strip, options);
  ASSERT_TRUE(r.proved);
  ASSERT_EQ(r.tile_weights.size(), r.tiles.size());
  EXPECT_NEAR(std::accumulate(r.tile_weights.begin(), r.tile_weights.end(), 0.0), r.weight, 1e-9);
  // Centres of neighbours are 15 mm apart, the last at least 15 mm from the end, so at best 4 centres are right of 40
  // mm.
  EXPECT_GE(r.weight, 2 * 9.0);
  EXPECT_LE(r.weight_bound, 4 * 9.0);
  EXPECT_GT(std::ranges::count(r.tile_weights, 0.0), 0);  // These modules are worth less than they weigh.
}

TEST(WeightRegions, bad_wishes_name_what_is_wrong) {
  const auto message = [](auto&& change) -> std::string {
    WeightRegions w = two_regions();
    change(w);
    try {
      (void)weight_map_of(w);
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  };
  using testing::HasSubstr;
  EXPECT_THAT(message([](WeightRegions& w) { w.regions.clear(); }), HasSubstr("no regions"));
  EXPECT_THAT(message([](WeightRegions& w) { w.regions[1].outline_mm.resize(2); }), HasSubstr("region 1 needs"));
  EXPECT_THAT(message([](WeightRegions& w) { w.regions[0].weight = -1.0; }), HasSubstr("weight of region 0 is -1"));
  EXPECT_THAT(message([](WeightRegions& w) { w.module_weight = std::nan(""); }), HasSubstr("module_weight"));
  EXPECT_THAT(message([](WeightRegions& w) { w.step_mm = 0.0; }), HasSubstr("must be positive"));
  EXPECT_THAT(message([](WeightRegions& w) { w.step_mm = 1e-3; }), HasSubstr("longer step"));
  EXPECT_THAT(message([](WeightRegions& w) { w.regions[0].outline_mm[0].x() = HUGE_VAL; }), HasSubstr("not finite"));
}

TEST(WeightRegions, are_read_from_a_file) {
  const auto file = std::filesystem::temp_directory_path() / ("weight_regions." + std::to_string(::getpid()) + ".json");
  std::ofstream(file) << R"({"step_mm": 5, "elsewhere": 1, "module_weight": 0.5, "regions": [
      {"weight": 3, "outline_mm": [[0, 0], [100, 0], [100, 100], [0, 100]]},
      {"weight": 5, "outline_mm": [[50, 0], [100, 0], [100, 100], [50, 100]]}]})";
  const WeightMap read = read_weight_map(file), made = weight_map_of(two_regions());
  for (const Vec2& p : {Vec2(25, 50), Vec2(48, 3), Vec2(75, 99), Vec2(-7, -7)})
    EXPECT_EQ(read.at(p).value, made.at(p).value);
  std::ofstream(file) << R"({"step_mm": 5, "regions": []})";
  EXPECT_THROW((void)read_weight_map(file), InputError);
  std::filesystem::remove(file);
}

TEST(WeightMap, errors_of_a_file_name_the_path) {
  const auto file = std::filesystem::temp_directory_path() / ("weight_map." + std::to_string(::getpid()) + ".json");
  const auto message = [&](const std::string& text) -> std::string {
    std::ofstream(file) << text;
    try {
      (void)read_weight_map(file);
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  };
  const std::string mesh = R"({"step_mm": 5, "vertices": [[0, 0, 1], [90, 0, -2], [0, 90, 1]], "faces": )";
  for (const auto& [text, words] : std::vector<std::pair<std::string, std::string>>{
           {R"({"step_mm": 5, "origin_mm": [0, 0], "rows": [[1, "a"]]})", "/rows/0/1: must be a number"},
           {R"({"step_mm": 5, "origin_mm": [0, 0], "rows": [[1]], "row": 1})", "/row: unknown key"},
           {R"({"step_mm": 5, "elsewhere": 1, "regions": [{"weight": 2, "outline_mm": [], "wieght": 1}]})",
            "/wieght: unknown"},
           {mesh + "[[0, 1, 3]]}", "/faces/0/2: must be in 0 … 2"},
           {mesh + "[[0, 1.5, 2]]}", "/faces/0/1: must be an integer"},
           {mesh + "[[0, 1, 2]]}", "vertex 1: -2 must be in 0 … 1e12"},
           {mesh.substr(0, mesh.rfind(',')) + "}", "\"faces\" is missing"},
           {"[1]", "not a map of weights"}}) {
    EXPECT_THAT(message(text), testing::AllOf(testing::HasSubstr(file.string()), testing::HasSubstr(words))) << text;
  }
  std::filesystem::remove(file);
}

TEST(WeightMap, weights_too_small_to_compare_count_as_0) {
  EXPECT_EQ(WeightMap({0, 0}, 10, {{5e-324, 1e-301}}).most(), 0.0);
  EXPECT_EQ(WeightMap({0, 0}, 10, {{1e-300, 0}}).most(), 1e-300);
}

}  // namespace
}  // namespace triskin::placement

// SPDX-License-Identifier: GPL-3.0-or-later
// The checker on layouts of several lattices: the search's own are right, and each damage is found by its rule.
#include "triskin/check/flat_layout.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "triskin/base/error.hpp"
#include "triskin/placement/lattices.hpp"
#include "triskin/placement/placement.hpp"

namespace triskin::check {
namespace {

using nlohmann::json;

const design::Polygon kOutline{{{0, 0}, {140, 0}, {140, 60}, {65, 60}, {65, 140}, {0, 140}},
                               {{{20, 20}, {20, 32}, {34, 32}, {34, 20}}}};

json layout_with(double gap_mm) {
  placement::LatticesOptions options;
  options.steps = 300;
  options.gap_mm = gap_mm;
  placement::PlacementOptions single;
  single.gap_mm = gap_mm;
  const placement::PlacementResult one = placement::place(kOutline, single);
  const placement::FlatLayout layout = placement::place_lattices(kOutline, {one.placement, one.tiles}, options);
  EXPECT_GT(layout.modules, 8);
  EXPECT_GT(layout.lattices.size(), 1U);
  return json::parse(placement::flat_layout_text(kOutline, layout, options));
}

std::set<std::string> broken(const json& layout) {
  std::set<std::string> rules;
  for (const Violation& v : check_flat_layout(layout.dump(), "layout").report.violations) rules.insert(v.rule);
  return rules;
}

TEST(FlatLayout, of_the_search_keeps_all_rules) {
  for (const double gap_mm : {0.0, 0.5, 3.0}) EXPECT_EQ(broken(layout_with(gap_mm)), std::set<std::string>{}) << gap_mm;
}

TEST(FlatLayout, each_damage_is_found_by_its_rule) {
  const json good = layout_with(0.5);
  json moved = good;
  moved["lattices"][0]["x_mm"] = moved["lattices"][0]["x_mm"].get<double>() + 200.0;
  EXPECT_TRUE(broken(moved).contains("flat-inside"));
  json nearer = good;
  nearer["lattices"][1]["theta_rad"] = nearer["lattices"][1]["theta_rad"].get<double>() + 0.5;
  EXPECT_FALSE(broken(nearer).empty());
  json twice = good;
  twice["lattices"][0]["tiles"].push_back(twice["lattices"][0]["tiles"][0]);
  EXPECT_EQ(broken(twice), (std::set<std::string>{"tile-unique", "flat-gap", "flat-number"}));
  json more = good;
  more["modules"] = more["modules"].get<int>() + 1;
  EXPECT_EQ(broken(more), std::set<std::string>{"flat-number"});
  json bound = good;
  bound["upper_bound"] = good["modules"];
  EXPECT_EQ(broken(bound), std::set<std::string>{"flat-bound"});
  EXPECT_THROW((void)check_flat_layout("{\"format\": \"triskin-flat-layout\"}", "layout"), InputError);
}

// Worked by hand: two modules of 30 mm on lattices of their own, side by side.
TEST(FlatLayout, modules_nearer_than_the_gap_are_named) {
  json layout = {{"format", "triskin-flat-layout"},
                 {"version", 1},
                 {"outer", {{-1, -1}, {70, -1}, {70, 30}, {-1, 30}}},
                 {"holes", json::array()},
                 {"gap_mm", 0.0},
                 {"tolerance_mm", 1e-6},
                 {"modules", 2},
                 {"upper_bound", 5},  // 71 × 31 / 389.7 = 5.65
                 {"lattices", json::array()}};
  const json tile = {{{"i", 0}, {"j", 0}, {"up", true}}};
  for (const double x : {0.0, 29.9})
    layout["lattices"].push_back({{"x_mm", -x}, {"y_mm", 0.0}, {"theta_rad", 0.0}, {"tiles", tile}});
  EXPECT_EQ(broken(layout), std::set<std::string>{"flat-gap"});  // They overlap by 0.1 mm at a corner.
  layout["lattices"][1]["x_mm"] = -30.5;
  EXPECT_EQ(broken(layout), std::set<std::string>{});
  layout["lattices"][1]["x_mm"] = -41.0;  // Beyond the right edge.
  EXPECT_EQ(broken(layout), std::set<std::string>{"flat-inside"});
}

}  // namespace
}  // namespace triskin::check

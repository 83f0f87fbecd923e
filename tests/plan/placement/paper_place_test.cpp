// SPDX-License-Identifier: GPL-3.0-or-later
// Runs the paper's heuristics by place() and by `triskin place --method`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "polygons.hpp"
#include "support/places.hpp"
#include "triskin/base/error.hpp"
#include "triskin/placement/placement.hpp"

namespace triskin::placement {
namespace {

constexpr std::array kPaperMethods{PlacementMethod::kR1, PlacementMethod::kR2, PlacementMethod::kR3,
                                   PlacementMethod::kR4, PlacementMethod::kR5, PlacementMethod::kR6,
                                   PlacementMethod::kR7};

PlacementResult placed(const Polygon& p, PlacementMethod method) {
  PlacementOptions options;
  options.method = method;
  options.largest_clearance = false;
  return place(p, options);
}

nlohmann::json answer(const std::filesystem::path& outline, const std::string& options) {
  const std::string command = test::program_file() + " place " + outline.string() + " --json " + options;
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  std::string text;
  std::array<char, 4096> buffer;
  while (const std::size_t n = fread(buffer.data(), 1, buffer.size(), pipe.get())) text.append(buffer.data(), n);
  return nlohmann::json::parse(text);
}

TEST(PaperPlace, the_program_evaluates_as_many_placements_as_the_formulas_say) {
  std::mt19937_64 random(71);
  const auto file = std::filesystem::path(testing::TempDir()) / "triskin_paper_place.geojson";
  for (std::int64_t n = 3; n <= 40; ++n) {
    std::vector<Vec2> ring = test::star(random, static_cast<int>(n), 60);
    ring.push_back(ring.front());
    nlohmann::json points = nlohmann::json::array();
    for (const Vec2& v : ring) points.push_back({v.x(), v.y()});
    std::ofstream(file) << nlohmann::json{{"type", "Polygon"}, {"coordinates", {points}}};
    const auto evaluations = [&](const std::string& method) {
      return answer(file, "--method " + method).at("evaluations").get<std::int64_t>();
    };
    ASSERT_EQ(evaluations("r2"), 2 * n);
    ASSERT_EQ(evaluations("r3"), n * (n - 1) / 2);
    ASSERT_EQ(evaluations("r4"), n * n * (n - 1) / 2);
  }
  EXPECT_EQ(answer(file, "--method r1 --draws 123").at("evaluations"), 123);
  EXPECT_EQ(answer(file, "--method r5 --draws 3").at("evaluations"), 80 * 4);
  const nlohmann::json r4 = answer(file, "--method r4 --line-deg 60 --node 2 -1");
  EXPECT_EQ(r4.at("modules"), answer(file, "--method r4").at("modules"));
  // The pivot moves to its place plus (x, y), which is the node (2, −1).
  const auto& pivoted = r4.at("pivoted_placement");
  const Vec2 node = grid_point(2, -1);
  EXPECT_NEAR(pivoted.at("pivot_mm").at(0).get<double>() + pivoted.at("x_mm").get<double>(), node.x(), 1e-9);
  EXPECT_NEAR(pivoted.at("pivot_mm").at(1).get<double>() + pivoted.at("y_mm").get<double>(), node.y(), 1e-9);
  std::filesystem::remove(file);
}

TEST(PaperPlace, tiles_are_those_of_the_placement_and_the_search_is_not_beaten) {
  std::mt19937_64 random(72);
  for (int k = 0; k < 6; ++k) {
    const Polygon p = test::random_polygon(random, 10 + 2 * k, 90, k % 3);
    const PlacementResult certified = placed(p, PlacementMethod::kBranchAndBound);
    for (const PlacementMethod method : kPaperMethods) {
      const PlacementResult r = placed(p, method);
      ASSERT_TRUE(r.pivoted);
      EXPECT_EQ(r.tiles.size(), static_cast<std::size_t>(r.modules));
      EXPECT_EQ(r.tiles, tiles_inside(p, r.placement, 1e-6));
      EXPECT_LE(r.modules, certified.modules);
    }
  }
}

// Nets of unfolders have cracks of zero width in a simple ring; some end in a module, through one of its nodes.
TEST(PaperPlace, cracks_of_zero_width_hold_no_module) {
  std::mt19937_64 random(73);
  for (int k = 0; k < 8; ++k) {
    const std::vector<Vec2> star = test::star(random, 10, 120, 0.1);
    Polygon p;
    for (std::size_t v = 0; v < star.size(); ++v) {
      p.outer.push_back(star[v]);
      if (v % 3 != 0) continue;
      for (const double in : {0.7, 0.4, 0.7, 1.0}) p.outer.emplace_back(in * star[v]);
    }
    const PlacementResult certified = placed(p, PlacementMethod::kBranchAndBound);
    for (const PlacementMethod method : kPaperMethods) {
      const PlacementResult r = placed(p, method);
      EXPECT_LE(r.modules, certified.modules);
      EXPECT_TRUE(std::ranges::includes(tiles_inside(normalize_polygon(p, "cracked"), r.placement, 1e-6), r.tiles));
    }
  }
}

TEST(PaperPlace, nothing_fits) {
  Polygon p;
  p.outer = {{0, 0}, {100, 0}, {100, 20}, {0, 20}};
  for (const PlacementMethod method : kPaperMethods) {
    const PlacementResult r = placed(p, method);
    EXPECT_EQ(r.modules, 0);
    EXPECT_TRUE(r.tiles.empty());
    EXPECT_FALSE(r.pivoted);
  }
}

TEST(PaperPlace, other_shapes_and_gaps_are_refused) {
  Polygon p;
  p.outer = {{0, 0}, {90, 0}, {0, 90}};
  PlacementOptions options;
  options.method = PlacementMethod::kR4;
  options.shape = TileShape::kHexagon;
  EXPECT_THROW((void)place(p, options), InputError);
  options.shape = TileShape::kTriangle;
  options.gap_mm = 1.0;
  EXPECT_THROW((void)place(p, options), InputError);
  options.method = PlacementMethod::kBranchAndBound;
  EXPECT_GT(place(p, options).modules, 0);
}

}  // namespace
}  // namespace triskin::placement

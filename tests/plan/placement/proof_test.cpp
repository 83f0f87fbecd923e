// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the proof log with a checker that shares no code with the solver; it must reject logs that were tampered with.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "polygons.hpp"
#include "triskin/base/error.hpp"
#include "triskin/check/placement_proof.hpp"
#include "triskin/placement/placement.hpp"

namespace triskin::placement {
namespace {

using nlohmann::json;

std::string geojson(const Polygon& p) {
  json rings = json::array();
  const auto add = [&](const std::vector<Vec2>& ring) {
    json points = json::array();
    for (const Vec2& v : ring) points.push_back({v.x(), v.y()});
    points.push_back(points[0]);
    rings.push_back(points);
  };
  add(p.outer);
  for (const auto& hole : p.holes) add(hole);
  return json{{"type", "Polygon"}, {"coordinates", rings}}.dump();
}

PlacementResult proved(const Polygon& p, TileShape shape = TileShape::kTriangle, double gap_mm = 0.0) {
  PlacementOptions options;
  options.shape = shape;
  options.gap_mm = gap_mm;
  options.keep_proof = true;
  options.largest_clearance = false;
  return place(p, options);
}

class ProofTest : public testing::Test {
 protected:
  void SetUp() override {
    std::mt19937_64 random(41);
    polygon_ = test::random_polygon(random, 16, 60, 1);
    file_ = geojson(polygon_);
    log_ = json::parse(proof_text(polygon_, proved(polygon_)));
  }
  [[nodiscard]] check::ProofReport report(const json& log) const {
    return check::check_placement_proof_text(log.dump(), file_);
  }
  void expect_rejected(const json& log, const std::string& reason) const {
    const auto r = report(log);
    EXPECT_FALSE(r.accepted);
    EXPECT_NE(r.reason.find(reason), std::string::npos) << r.reason;
  }

  Polygon polygon_;
  std::string file_;
  json log_;
};

TEST_F(ProofTest, squares_and_hexagons_are_proved_too) {
  std::mt19937_64 random(43);
  for (const TileShape shape : {TileShape::kSquare, TileShape::kHexagon}) {
    for (const double gap_mm : {0.0, 1.5}) {
      const Polygon p = test::random_polygon(random, 12, 200, 0);
      const PlacementResult best = proved(p, shape, gap_mm);
      EXPECT_GT(best.modules, 0);
      json log = json::parse(proof_text(p, best));
      const auto check = [&] { return check::check_placement_proof_text(log.dump(), geojson(p)); };
      EXPECT_TRUE(check().accepted) << check().reason;
      log["upper_bound"] = log["modules"] = best.modules - 1;
      log["tiles"].erase(0);
      EXPECT_FALSE(check().accepted);
      log = json::parse(proof_text(p, best));
      log["shape"] = shape == TileShape::kSquare ? "hexagon" : "square";
      EXPECT_FALSE(check().accepted);
      log["shape"] = "circle";
      EXPECT_NE(check().reason.find("must be triangle, square or hexagon"), std::string::npos);
    }
  }
}

TEST_F(ProofTest, an_honest_log_is_accepted) {
  const auto r = report(log_);
  EXPECT_TRUE(r.accepted) << r.reason;
  EXPECT_EQ(r.modules, r.upper_bound);
  EXPECT_GT(r.cells, 20);
}

TEST_F(ProofTest, a_missing_cell_is_noticed_whichever_it_is) {
  std::mt19937_64 random(42);
  for (int k = 0; k < 8; ++k) {
    json log = log_;
    log["cells"].erase(static_cast<std::size_t>(random() % log["cells"].size()));
    expect_rejected(log, "no cell covers");
  }
}

TEST_F(ProofTest, a_lowered_bound_is_noticed) {
  json log = log_;
  log["upper_bound"] = log["upper_bound"].get<int>() - 1;
  expect_rejected(log, "below");
  log["modules"] = log["modules"].get<int>() - 1;
  expect_rejected(log, "does not list");
  log["tiles"].erase(0);
  expect_rejected(log, "may lie inside");  // Only the cells can reveal the lie now.
}

TEST_F(ProofTest, a_moved_edge_is_noticed_in_either_file) {
  json log = log_;
  log["rings"][0][3][0] = log["rings"][0][3][0].get<double>() + 1e-9;
  expect_rejected(log, "not the polygon of the file");
  Polygon larger = polygon_;
  for (Vec2& v : larger.outer) v *= 1.15;  // Both files have the same lie.
  log = log_;
  log["rings"] = json::parse(geojson(larger))["coordinates"];
  const auto r = check::check_placement_proof_text(log.dump(), geojson(larger));
  EXPECT_FALSE(r.accepted);
  EXPECT_NE(r.reason.find("may lie inside"), std::string::npos) << r.reason;
}

TEST_F(ProofTest, a_shrunk_cell_a_shifted_placement_and_a_doubled_module_are_noticed) {
  json log = log_;
  log["cells"][5][1] = 0.5 * (log["cells"][5][0].get<double>() + log["cells"][5][1].get<double>());
  expect_rejected(log, "no cell covers");
  log = log_;
  log["motion"][0] = log["motion"][0].get<double>() + 20.0;
  expect_rejected(log, "does not lie inside");
  log = log_;
  log["tiles"][1] = log["tiles"][0];
  expect_rejected(log, "twice");
}

TEST_F(ProofTest, the_report_says_what_the_log_is_about) {
  const auto r = report(log_);
  EXPECT_EQ(r.shape, "triangle");
  EXPECT_EQ(r.tolerance_mm, 1e-6);
  EXPECT_EQ(r.gap_mm, 0.0);
  EXPECT_EQ(r.corner_cut_mm, 0.0);
  EXPECT_EQ(r.weights, "none");
  EXPECT_NEAR(r.outline_area_mm2, polygon_area(polygon_), 1e-9 * r.outline_area_mm2);
  Polygon turned = polygon_;  // The outline is the same, but its rings begin elsewhere.
  std::ranges::rotate(turned.outer, turned.outer.begin() + 5);
  std::ranges::reverse(turned.holes[0]);
  EXPECT_EQ(check::check_placement_proof_text(log_.dump(), geojson(turned)).outline_hash, r.outline_hash);
  turned.outer[0].x() += 1e-9;
  EXPECT_NE(check::check_placement_proof_text(log_.dump(), geojson(turned)).outline_hash, r.outline_hash);
}

// With another tolerance the log may still be true, but the claim is another one.
TEST_F(ProofTest, a_log_about_something_else_than_expected_is_rejected) {
  json log = log_;
  log["tolerance_mm"] = 1e-3;
  EXPECT_TRUE(report(log).accepted);
  EXPECT_EQ(report(log).tolerance_mm, 1e-3);
  const auto rejection = [&](const check::ProofExpectation& expected) {
    return check::check_placement_proof_text(log.dump(), file_, expected).reason;
  };
  EXPECT_EQ(rejection({.tolerance_mm = 1e-3, .gap_mm = 0.0, .corner_cut_mm = 0.0, .shape = "triangle"}), "");
  EXPECT_THAT(rejection({.tolerance_mm = 1e-6}), testing::HasSubstr("tolerance of 0.001 mm, not 1e-06"));
  EXPECT_THAT(rejection({.gap_mm = 2.0}), testing::HasSubstr("a gap of 0 mm"));
  EXPECT_THAT(rejection({.corner_cut_mm = 1.0}), testing::HasSubstr("corner cut"));
  EXPECT_THAT(rejection({.shape = "hexagon"}), testing::HasSubstr("shape triangle"));
  EXPECT_THAT(rejection({.outline_hash = "0"}), testing::HasSubstr("outline"));
  EXPECT_THAT(rejection({.modules = log["modules"].get<int>() + 1}), testing::HasSubstr("modules"));
}

TEST_F(ProofTest, what_is_no_log_is_an_input_error) {
  json log = log_;
  log.erase("pivot");
  EXPECT_THROW((void)report(log), InputError);
  EXPECT_THROW((void)check::check_placement_proof_text("{", file_), InputError);
  EXPECT_THROW((void)check::check_placement_proof_text(log_.dump(), ""), InputError);
  EXPECT_THROW((void)check::check_placement_proof_text(log_.dump(), "POLYGON ((0 0, x 1))"), InputError);
}

TEST(Proof, holds_when_nothing_fits_and_for_an_exact_union_of_tiles) {
  Polygon strip;
  strip.outer = {{0, 0}, {300, 0}, {300, 20}, {0, 20}};
  Polygon triangle;
  triangle.outer = {{0, 0}, {90, 0}, {45, 3 * kHeight_mm}};
  for (const Polygon& p : {strip, triangle, test::moved(triangle, 0.3, {1e6, -1e6})}) {
    const auto r = check::check_placement_proof_text(proof_text(p, proved(p)), geojson(p));
    EXPECT_TRUE(r.accepted) << r.reason;
  }
}

// Makes a log with the whole period as its only cell, and no module placed.
json log_of_one_cell(const Polygon& p, int upper_bound) {
  json ring = json::array();
  for (const Vec2& v : p.outer) ring.push_back({v.x(), v.y()});
  ring.push_back(ring[0]);
  return {{"format", "triskin-placement-proof"},
          {"version", 1},
          {"rings", {ring}},
          {"pivot", {0.5 * p.outer[2].x(), 0.5 * p.outer[2].y()}},
          {"pitch_mm", kSide_mm},
          {"tolerance_mm", 1e-6},
          {"modules", 0},
          {"upper_bound", upper_bound},
          {"motion", {0.0, 0.0, 0.0}},
          {"tiles", json::array()},
          {"cells", {{0.0, kSide_mm, 0.0, 26.0, 0.0, 1.05}}}};
}

Polygon strip(double length_mm) {
  Polygon p;
  p.outer = {{0, 0}, {length_mm, 0}, {length_mm, 40}, {0, 40}};
  return p;
}

// A module has 389.7 mm², so 8 m² have room for 20,528 at most; lists of the modules near the outline would be long.
TEST(Proof, a_bound_by_area_needs_no_list_of_modules) {
  const Polygon p = strip(200'000.0);
  const auto report = check::check_placement_proof_text(log_of_one_cell(p, 20'528).dump(), geojson(p));
  EXPECT_TRUE(report.accepted) << report.reason;
  EXPECT_EQ(report.regions, 0);
}

// 12,000 mm² have room for 30 modules. A smaller bound takes regions, and every bound takes cells that cover the
// period.
TEST(Proof, the_area_proves_no_smaller_bound_and_no_gap_between_cells) {
  const Polygon p = strip(300.0);
  const auto report = [&](const json& log) { return check::check_placement_proof_text(log.dump(), geojson(p)); };
  EXPECT_EQ(report(log_of_one_cell(p, 30)).regions, 0);
  const auto below = report(log_of_one_cell(p, 29));
  EXPECT_TRUE(below.accepted) << below.reason;
  EXPECT_GT(below.regions, 0);
  json log = log_of_one_cell(p, 30);
  log["cells"][0][5] = 1.0;
  EXPECT_FALSE(report(log).accepted);
}

}  // namespace
}  // namespace triskin::placement

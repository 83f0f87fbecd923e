// SPDX-License-Identifier: GPL-3.0-or-later
// For 500 random polygons per run, the result must be proved, not beaten by a heuristic, the same after a rigid motion
// and renumbering, and its proof accepted.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "polygons.hpp"
#include "scans.hpp"
#include "triskin/check/placement_proof.hpp"
#include "triskin/placement/placement.hpp"

namespace triskin::placement {
namespace {

constexpr std::uint64_t kSeed = 500;

std::string wkt(const Polygon& p) {
  std::string text = "POLYGON (";
  const auto add = [&](const std::vector<Vec2>& ring) {
    text += text.ends_with("(") ? "(" : ", (";
    for (std::size_t k = 0; k <= ring.size(); ++k) {
      const Vec2& v = ring[k % ring.size()];
      text += (k > 0 ? ", " : "") + nlohmann::json(v.x()).dump() + " " + nlohmann::json(v.y()).dump();
    }
    text += ")";
  };
  add(p.outer);
  for (const auto& hole : p.holes) add(hole);
  return text + ")";
}

PlacementResult run(const Polygon& p, PlacementMethod method, bool proof = false) {
  PlacementOptions options;
  options.method = method;
  options.keep_proof = proof;
  options.largest_clearance = false;
  return place(p, options);
}

class RandomPolygons : public testing::TestWithParam<int> {};

TEST_P(RandomPolygons, certified_value_holds_against_everything_else) {
  std::mt19937_64 random(kSeed + static_cast<std::uint64_t>(GetParam()));
  for (int k = 0; k < 50; ++k) {
    const int vertices = 5 + static_cast<int>(random() % 12);
    const double area_cm2 = test::uniform(random, 8, 60);
    // A smaller outline may have no room for a hole.
    const Polygon p = test::random_polygon(random, vertices, area_cm2, vertices > 8 && area_cm2 > 45 ? 1 : 0);
    SCOPED_TRACE(testing::Message() << "seed " << kSeed + static_cast<std::uint64_t>(GetParam()) << " polygon " << k
                                    << " " << wkt(p));
    const PlacementResult best = run(p, PlacementMethod::kBranchAndBound, true);
    ASSERT_TRUE(best.proved);
    ASSERT_EQ(tiles_inside(p, best.placement, 2e-6).size(), static_cast<std::size_t>(best.modules));
    for (const auto method : {PlacementMethod::kR1, PlacementMethod::kR2, PlacementMethod::kR3, PlacementMethod::kR4,
                              PlacementMethod::kR5, PlacementMethod::kR6, PlacementMethod::kR7}) {
      ASSERT_LE(run(p, method).modules, best.upper_bound);
    }
    ASSERT_LE(test::most_by_scan(p, 0.0, kSeed), best.upper_bound);
    Polygon other = test::moved(p, test::uniform(random, -3, 3), {test::uniform(random, -500, 500), 77}, k % 2 == 0);
    std::ranges::rotate(other.outer, other.outer.begin() + 2);
    ASSERT_EQ(run(other, PlacementMethod::kBranchAndBound).modules, best.modules);
    const auto report = check::check_placement_proof_text(proof_text(p, best), wkt(p));
    ASSERT_TRUE(report.accepted) << report.reason;
  }
}

INSTANTIATE_TEST_SUITE_P(Property, RandomPolygons, testing::Range(0, 10));

}  // namespace
}  // namespace triskin::placement

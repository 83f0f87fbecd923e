// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the limits that end a search early, and outlines that are long or far away.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "polygons.hpp"
#include "triskin/base/error.hpp"
#include "triskin/check/placement_proof.hpp"
#include "triskin/placement/placement.hpp"

namespace triskin::placement {
namespace {

using testing::HasSubstr;

// The disc misses the hexagon of 24 tiles only slightly, which makes a long search.
Polygon hard() {
  Polygon p;
  for (int k = 0; k < 361; ++k) {
    const double angle = 2.0 * M_PI * k / 361;
    p.outer.emplace_back(59.9999 * std::cos(angle), 59.9999 * std::sin(angle));
  }
  return p;
}

std::string wkt(const Polygon& p) {
  std::string text = "POLYGON ((";
  for (const Vec2& v : p.outer) text += fmt::format("{} {}, ", v.x(), v.y());
  return text + fmt::format("{} {}))", p.outer[0].x(), p.outer[0].y());
}

PlacementOptions limited(double memory_mb, double proof_mb) {
  PlacementOptions options;
  options.time_limit_s = 0.0;
  options.memory_limit_mb = memory_mb;
  options.proof_limit_mb = proof_mb;
  options.largest_clearance = false;
  return options;
}

struct Logged {
  PlacementResult result;
  std::string log;
};

Logged place_with_log(const Polygon& p, PlacementOptions options) {
  Logged logged;
  ProofWriter writer([&](std::string_view part) { logged.log += part; });
  options.proof_cell = [&](const ProofCell& cell) { writer.add_cell(cell); };
  logged.result = place(p, options);
  writer.finish(p, logged.result);
  return logged;
}

TEST(Limits, of_memory_leaves_an_open_bound_that_the_log_proves) {
  const Logged r = place_with_log(hard(), limited(2.0, 300.0));
  EXPECT_EQ(r.result.stopped, SearchStop::kMemory);
  EXPECT_FALSE(r.result.proved);
  EXPECT_EQ(r.result.modules, 18);
  EXPECT_GT(r.result.upper_bound, 18);
  const auto report = check::check_placement_proof_text(r.log, wkt(hard()));
  EXPECT_TRUE(report.accepted) << report.reason;
}

TEST(Limits, of_the_proof_holds_for_its_text) {
  const Logged r = place_with_log(hard(), limited(2000.0, 1.0));
  EXPECT_EQ(r.result.stopped, SearchStop::kProofSize);
  EXPECT_LT(r.log.size(), 1'000'000U);
  EXPECT_GT(r.result.upper_bound, r.result.modules);
}

TEST(Limits, the_log_is_the_same_in_parts_and_at_once) {
  Polygon p;
  p.outer = {{0, 0}, {100, 0}, {120, 80}, {10, 90}};
  PlacementOptions options = limited(2000.0, 300.0);
  const Logged parts = place_with_log(p, options);
  EXPECT_EQ(parts.result.stopped, SearchStop::kNone);
  EXPECT_TRUE(parts.result.proof.cells.empty());
  options.keep_proof = true;
  EXPECT_EQ(parts.log, proof_text(p, place(p, options)));
}

TEST(Limits, out_of_range_are_refused) {
  EXPECT_THROW((void)place(hard(), limited(0.0, 300.0)), InputError);
  EXPECT_THROW((void)place(hard(), limited(2000.0, 0.5)), InputError);
}

std::string refusal(const Polygon& p, double tolerance_mm) {
  PlacementOptions options;
  options.tolerance_mm = tolerance_mm;
  try {
    (void)place(p, options);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(Radius, what_doubles_cannot_resolve_is_refused_with_a_reason) {
  Polygon needle;
  needle.outer = {{0, 0}, {2.5e6, 0}, {2.5e6, 40}, {0, 40}};
  EXPECT_THAT(refusal(needle, 1e-6), HasSubstr("more than 1 km"));
  for (Vec2& v : needle.outer) v.x() *= 0.4;
  EXPECT_THAT(refusal(needle, 1e-8), HasSubstr("--tolerance-mm"));
  Polygon away;
  away.outer = {{99999900, 0}, {1e8, 0}, {1e8, 100}, {99999900, 100}};
  EXPECT_THAT(refusal(away, 1e-8), HasSubstr("from the origin"));
  EXPECT_EQ(refusal(away, 1e-6), "");
}

// At most angles the raster of the needle would take more than a gigabyte; those stay open, and the others give a
// value.
TEST(Radius, a_needle_of_100_m_ends_with_an_open_bound_that_its_log_proves) {
  Polygon needle;
  needle.outer = {{0, 0}, {1e5, 0}, {1e5, 40}, {0, 40}};
  PlacementOptions options = limited(2000.0, 300.0);
  options.tolerance_mm = 1e-4;
  options.time_limit_s = 4.0;
  const Logged r = place_with_log(needle, options);
  EXPECT_NE(r.result.stopped, SearchStop::kNone);
  EXPECT_GT(r.result.modules, 3000);
  EXPECT_GT(r.result.upper_bound, r.result.modules);
  const auto report = check::check_placement_proof_text(r.log, wkt(needle));
  EXPECT_TRUE(report.accepted) << report.reason;
}

TEST(Radius, an_outline_far_from_the_origin_holds_as_many_as_at_it) {
  Polygon near;
  near.outer = {{0, 0}, {100, 0}, {100, 100}, {0, 100}};
  Polygon far = near;
  for (Vec2& v : far.outer) v += Vec2(99999900, -99999900);
  EXPECT_EQ(place(near).modules, place(far).modules);
}

TEST(Touching, a_hole_that_crosses_the_outer_ring_by_rounding_touches_it) {
  Polygon p;
  p.outer = {{0, 0}, {200, 0}, {200, 200}, {0, 200}};
  p.holes = {{{0, 80}, {40, 100}, {0, 120}}};
  for (int k = 0; k < 20; ++k) EXPECT_NO_THROW((void)test::moved(p, 0.3 * k, {1e6, -1e6})) << k;
  p.holes[0][0].x() = p.holes[0][2].x() = -5e-10;
  EXPECT_NO_THROW((void)normalize_polygon(p, "p"));
  p.holes[0][0].x() = -1e-6;
  EXPECT_THROW((void)normalize_polygon(p, "p"), InputError);
}

}  // namespace
}  // namespace triskin::placement

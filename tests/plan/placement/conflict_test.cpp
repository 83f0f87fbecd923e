// SPDX-License-Identifier: GPL-3.0-or-later
// In these outlines every constraint alone can hold, but two or three together cannot. The values are worked by hand,
// and the checker, which shares no code with the search, proves the bounds.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "polygons.hpp"
#include "triskin/check/placement_proof.hpp"
#include "triskin/placement/placement.hpp"

namespace triskin::placement {
namespace {

// Without contradictions some of these would take millions of cells and not end.
constexpr std::int64_t kMaxCells = 60'000;

std::string wkt(const Polygon& p) {
  std::string text = "POLYGON ((";
  for (const Vec2& v : p.outer) text += fmt::format("{} {}, ", v.x(), v.y());
  return text + fmt::format("{} {}))", p.outer[0].x(), p.outer[0].y());
}

struct Answer {
  PlacementResult placement;
  check::ProofReport proof;
};

Answer place_and_check(const Polygon& p, double tolerance_mm) {
  PlacementOptions options;
  options.tolerance_mm = tolerance_mm;
  options.keep_proof = true;
  options.largest_clearance = false;
  options.time_limit_s = 0.0;
  Answer answer{place(p, options), {}};
  answer.proof = check::check_placement_proof_text(proof_text(p, answer.placement), wkt(p));
  return answer;
}

void expect_value(const Polygon& p, double tolerance_mm, int modules) {
  const Answer a = place_and_check(p, tolerance_mm);
  EXPECT_EQ(a.placement.modules, modules);
  EXPECT_TRUE(a.placement.proved);
  EXPECT_LT(a.placement.cells, kMaxCells);
  EXPECT_TRUE(a.proof.accepted) << a.proof.reason;
}

Polygon rectangle(double length_mm, double width_mm) {
  Polygon p;
  p.outer = {{0, 0}, {length_mm, 0}, {length_mm, width_mm}, {0, width_mm}};
  return p;
}

// Makes the trapezoid of a row of n triangles, with all its sides moved in by `inset_mm`.
Polygon trapezoid(int n, double inset_mm) {
  const double low_mm = kSide_mm * ((n + 1) / 2), high_mm = kSide_mm * (n / 2), d = inset_mm;
  // A side that leans by 60° moves along the level sides by 2/√3 of the inset, and 1/√3 more where it meets them.
  const double acute = std::sqrt(3.0) * d, obtuse = d / std::sqrt(3.0);
  const bool even = n % 2 == 0;
  Polygon p;
  p.outer = {{acute, d},
             {low_mm - (even ? obtuse : acute), d},
             {kSide_mm / 2 + high_mm - (even ? acute : obtuse), kHeight_mm - d},
             {kSide_mm / 2 + obtuse, kHeight_mm - d}};
  if (n == 1) p.outer = {{acute, d}, {low_mm - acute, d}, {kSide_mm / 2, kHeight_mm - 2.0 * d}};
  return p;
}

// Makes teeth `width_mm` wide on a back; none fits in one of 20 mm.
Polygon comb(int teeth, double width_mm, double length_mm, double back_mm = 20.0) {
  constexpr double kBetween_mm = 17.0;
  double x = teeth * width_mm + (teeth - 1) * kBetween_mm;
  Polygon p;
  p.outer = {{0.0, 0.0}, {x, 0.0}};
  for (int k = 0; k < teeth; ++k) {
    p.outer.emplace_back(x, back_mm + length_mm);
    x -= width_mm;
    p.outer.emplace_back(x, back_mm + length_mm);
    if (k + 1 == teeth) break;
    p.outer.emplace_back(x, back_mm);
    x -= kBetween_mm;
    p.outer.emplace_back(x, back_mm);
  }
  return p;
}

TEST(Conflicts, a_strip_a_hair_narrower_than_a_row_holds_nothing) {
  int turn = 0;
  for (const double length_mm : {300.0, 1000.0}) {
    for (const double less_mm : {1e-1, 1e-4, 1e-7}) {
      SCOPED_TRACE(fmt::format("{} x (h - {})", length_mm, less_mm));
      expect_value(test::moved(rectangle(length_mm, kHeight_mm - less_mm), 0.3 * ++turn, {400.0, -70.0}), 1e-8, 0);
    }
  }
}

TEST(Conflicts, within_the_tolerance_the_row_fits) {
  // 300 mm hold ten up triangles and the nine down ones between them.
  expect_value(test::moved(rectangle(300.0, kHeight_mm - 1e-5), 0.7, {0, 0}), 1e-4, 19);
  expect_value(test::moved(rectangle(300.0, kHeight_mm - 1e-7), 1.9, {0, 0}), 1e-6, 19);
}

TEST(Conflicts, a_trapezoid_of_modules_moved_in_by_a_hair_holds_nothing) {
  for (const int n : {1, 2, 3, 7, 30}) {
    for (const double inset_mm : {1e-3, 1e-7}) {
      SCOPED_TRACE(fmt::format("{} modules, {} mm", n, inset_mm));
      expect_value(test::moved(trapezoid(n, inset_mm), 0.4 + n, {-30, 11}), 1e-8, 0);
      expect_value(test::moved(trapezoid(n, inset_mm), 0.9 + n, {-30, 11}), 4.0 * inset_mm, n);
    }
  }
}

// In a strip that is a hair less than two rows wide, the tiles of either row exclude those of the other.
TEST(Conflicts, two_rows_of_a_strip_exclude_each_other) {
  for (const double less_mm : {1e-2, 1e-5}) {
    const Answer a = place_and_check(test::moved(rectangle(150.0, 2.0 * kHeight_mm - less_mm), 1.1, {7, -3}), 1e-8);
    EXPECT_TRUE(a.placement.proved);
    EXPECT_GE(a.placement.modules, 9);  // One row holds as many; other angles may hold more.
    EXPECT_LT(a.placement.cells, kMaxCells);
    EXPECT_TRUE(a.proof.accepted) << a.proof.reason;
  }
}

// A module of the narrow back may have its top in the mouths of the teeth and turn by a hair. Then it holds alone: of
// all such modules each excludes every other, which no pairing of them shows.
TEST(Conflicts, of_modules_that_exclude_each_other_all_together_one_holds) {
  for (const auto& [teeth, less_mm] : {std::pair{6, 1e-4}, std::pair{10, 2e-7}}) {
    SCOPED_TRACE(fmt::format("{} teeth, h - {}", teeth, less_mm));
    const double width_mm = kHeight_mm - less_mm;
    const Answer a = place_and_check(test::moved(comb(teeth, width_mm, 166.0, width_mm), 2.1, {-9, 4}), 2e-8);
    EXPECT_TRUE(a.placement.proved);
    EXPECT_LT(a.placement.cells, kMaxCells / 4);
    EXPECT_TRUE(a.proof.accepted) << a.proof.reason;
  }
}

// Here one of such modules leaves no room for another one at the far end of the back, so that four are needed to show
// it.
TEST(Conflicts, in_a_narrow_back_with_wide_teeth_four_modules_contradict_each_other) {
  const Polygon p = comb(5, 2.0 * kHeight_mm - 2.1e-7, 84.0, kHeight_mm - 2.1e-7);
  const Answer a = place_and_check(test::moved(p, 5.3, {12, 30}), 8.5e-8);
  EXPECT_TRUE(a.placement.proved);
  EXPECT_LT(a.placement.cells, kMaxCells / 4);
  EXPECT_TRUE(a.proof.accepted) << a.proof.reason;
}

// In a tooth slightly less than two rows wide, the lower row needs one side and the upper row the other.
TEST(Conflicts, two_rows_of_a_tooth_exclude_each_other) {
  for (const double less_mm : {1e-2, 1e-5}) {
    const Polygon p = test::moved(comb(3, 2.0 * kHeight_mm - less_mm, 120.0), 0.2, {5, 5});
    const Answer one = place_and_check(p, 1e-8), both = place_and_check(p, 2.0 * less_mm);
    EXPECT_TRUE(one.placement.proved);
    EXPECT_LT(one.placement.cells, kMaxCells);
    EXPECT_TRUE(one.proof.accepted) << one.proof.reason;
    EXPECT_TRUE(both.placement.proved);
    EXPECT_GT(both.placement.modules, one.placement.modules);  // Wider by the tolerance, the teeth hold two rows.
  }
}

}  // namespace
}  // namespace triskin::placement

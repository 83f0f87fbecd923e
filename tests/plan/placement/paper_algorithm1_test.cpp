// SPDX-License-Identifier: GPL-3.0-or-later
// Compares both versions of the paper's Algorithm 1 with an independent exact count, and shows where it is wrong.
#include <gtest/gtest.h>

#include "exact_count.hpp"
#include "polygons.hpp"
#include "triskin/placement/paper/algorithm1.hpp"

namespace triskin::placement::paper {
namespace {

constexpr CgalUse kInexact{}, kExact{.exact_constructions = true};

constexpr std::uint64_t kSeed = 20130102;

PivotedPlacement random_placement(std::mt19937_64& random, const Polygon& p) {
  const int vertex = static_cast<int>(random() % (p.outer.size() + 1)) - 1;
  return {test::uniform(random, -100, 100), test::uniform(random, -100, 100), test::uniform(random, -4, 4), vertex};
}

TEST(PaperAlgorithm1, equals_an_exact_count_on_2000_placements_of_10_simple_polygons) {
  std::mt19937_64 random(kSeed);
  int with_modules = 0;
  for (int polygon = 0; polygon < 10; ++polygon) {
    const Polygon p = test::random_polygon(random, 8 + 4 * polygon, 40.0 + 12.0 * polygon, 0);
    Algorithm1 fast(p);
    for (int k = 0; k < 200; ++k) {
      SCOPED_TRACE(testing::Message() << "seed " << kSeed << " polygon " << polygon << " placement " << k);
      const PivotedPlacement at = random_placement(random, p);
      const auto expected = test::ExactCount(p, without_pivot(p, at)).tiles();
      ASSERT_EQ(fast.patch(at), expected);
      ASSERT_EQ(fast.count(at), static_cast<int>(expected.size()));
      ASSERT_EQ(algorithm1_cgal(p, at, kInexact), expected);
      ASSERT_EQ(algorithm1_cgal(p, at, kExact), expected);
      with_modules += expected.empty() ? 0 : 1;
    }
  }
  EXPECT_GT(with_modules, 1800);
}

// If no edge lies on a line, the three wordings of the rule are equivalent.
TEST(PaperAlgorithm1, the_three_wordings_agree_on_generic_placements) {
  std::mt19937_64 random(kSeed + 1);
  const Polygon p = test::random_polygon(random, 30, 100, 0);
  Algorithm1 closure(p), letter(p, {.sides = ContainedSides::kTheorem2}),
      listing(p, {.sides = ContainedSides::kContainmentInterval});
  for (int k = 0; k < 100; ++k) {
    const PivotedPlacement at = random_placement(random, p);
    const auto patch = closure.patch(at);
    EXPECT_EQ(letter.patch(at), patch);
    EXPECT_EQ(listing.patch(at), patch);
  }
}

TEST(PaperAlgorithm1, a_far_polygon_has_the_patch_of_the_near_one) {
  std::mt19937_64 random(kSeed + 2);
  const Polygon near = test::random_polygon(random, 25, 120, 0), far = test::moved(near, 0.0, {1e6, -2e6});
  for (int k = 0; k < 20; ++k) {
    const PivotedPlacement at{test::uniform(random, 0, 30), test::uniform(random, 0, 26), test::uniform(random, 0, 1),
                              3};
    PivotedPlacement there = at;
    there.x_mm -= 1e6;
    there.y_mm += 2e6;
    EXPECT_EQ(Algorithm1(far).patch(there), Algorithm1(near).patch(at));
  }
}

// The pivot is the centre of the turn, so the vertex moves to its place plus (x, y), whatever the angle.
TEST(PaperAlgorithm1, the_pivot_moves_by_x_and_y_alone) {
  std::mt19937_64 random(kSeed + 3);
  const Polygon p = test::random_polygon(random, 9, 60, 0);
  for (int v = 0; v < 9; ++v) {
    const Placement m = without_pivot(p, {3.0, -4.0, 0.7, v});
    const Vec2& from = p.outer[static_cast<std::size_t>(v)];
    const Vec2 to = Eigen::Rotation2Dd(m.theta_rad) * from + Vec2(m.x_mm, m.y_mm);
    EXPECT_NEAR((to - from - Vec2(3.0, -4.0)).norm(), 0.0, 1e-12);
  }
  EXPECT_THROW((void)without_pivot(p, {0, 0, 0, 9}), std::out_of_range);
  EXPECT_THROW((void)Algorithm1(p).count({0, 0, 0, 9}), std::out_of_range);
  EXPECT_THROW(Algorithm1(p, {.touch_mm = -1e-6}), std::invalid_argument);
}

// The paper takes one simple polygon. With holes the intervals follow from parity, but three contained sides cannot
// reveal a hole within a module.
TEST(PaperAlgorithm1, counts_a_module_with_a_hole_inside) {
  std::mt19937_64 random(33);
  Polygon p = test::random_polygon(random, 20, 100, 0);
  p.holes = {{{-30, 10}, {-28, 13}, {-27, 10}}, {{30, -10}, {32, -7}, {33, -10}}};
  p = normalize_polygon(p, "two holes of 3 mm");
  Algorithm1 as_written(p), amended(p, {.reject_pierced = true});
  int wrong = 0;
  for (int k = 0; k < 200; ++k) {
    const PivotedPlacement at = random_placement(random, p);
    const auto expected = test::ExactCount(p, without_pivot(p, at)).tiles(), patch = as_written.patch(at);
    EXPECT_TRUE(std::ranges::includes(patch, expected));
    EXPECT_EQ(algorithm1_cgal(p, at, kInexact), patch);
    EXPECT_EQ(amended.patch(at), expected);
    wrong += patch != expected ? 1 : 0;
  }
  EXPECT_GT(wrong, 20);
  EXPECT_LT(wrong, 180);
}

TEST(PaperAlgorithm1, parity_takes_care_of_holes_larger_than_a_module) {
  std::mt19937_64 random(34);
  Polygon p = test::random_polygon(random, 20, 200, 0);
  p.holes = {test::star(random, 12, 40)};
  p = normalize_polygon(p, "ring");
  Algorithm1 fast(p);
  for (int k = 0; k < 100; ++k) {
    const PivotedPlacement at = random_placement(random, p);
    EXPECT_EQ(fast.patch(at), test::ExactCount(p, without_pivot(p, at)).tiles());
  }
}

}  // namespace
}  // namespace triskin::placement::paper

// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "triskin/geometry/segment.hpp"
#include "triskin/geometry/triangle.hpp"

namespace triskin::geometry {
namespace {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(Segment, NearestPlaceIsInsideOrAnEnd) {
  const Vec2 a(0, 0), b(4, 0);
  EXPECT_EQ(part_of_segment(Vec2(1, 7), a, b), 0.25);
  EXPECT_EQ(part_of_segment(Vec2(-1, 7), a, b), 0.0);
  EXPECT_EQ(part_of_segment(Vec2(9, 7), a, b), 1.0);
  EXPECT_EQ(distance_to_segment(Vec2(1, 7), a, b), 7.0);
  EXPECT_EQ(distance_to_segment(Vec2(7, 4), a, b), 5.0);  // 3, 4, 5 beyond the end.
  EXPECT_EQ(closest_on_segment(Vec3(1, 0, 2), Vec3(0, 0, 0), Vec3(4, 0, 0)), Vec3(1, 0, 0));
}

TEST(Segment, EqualEndsAreAPoint) {
  const Vec3 a(1, 2, 3);
  EXPECT_EQ(part_of_segment(Vec3(4, 6, 3), a, a), 0.0);
  EXPECT_EQ(distance_to_segment(Vec3(4, 6, 3), a, a), 5.0);
  EXPECT_EQ(distance_to_segment(a, a, a), 0.0);
  const Vec2 c(0, 0), d(1e-170, 0);  // Its square is 0 in double precision.
  EXPECT_EQ(distance_to_segment(Vec2(3, 4), c, d), 5.0);
}

TEST(Segment, ShortAndFarOnesKeepTheirDistance) {
  EXPECT_EQ(distance_to_segment(Vec2(5e-10, 1), Vec2(0, 0), Vec2(1e-9, 0)), 1.0);
  // 1e9 mm from the origin doubles are 1.2e-7 mm apart.
  const Vec3 far(1e9, -1e9, 1e9);
  EXPECT_NEAR(distance_to_segment(Vec3(far + Vec3(1, 3, 0)), far, Vec3(far + Vec3(2, 0, 0))), 3.0, 1e-6);
  EXPECT_NEAR(distance_to_segment(Vec3(0, 3, 0), Vec3(-1e9, 0, 0), Vec3(1e9, 0, 0)), 3.0, 1e-6);
}

TEST(Segment, InfinitePointIsInfinitelyFar) {
  EXPECT_EQ(distance_to_segment(Vec2(kInfinity, 0), Vec2(0, 0), Vec2(4, 0)), kInfinity);
  EXPECT_EQ(distance_to_segment(Vec2(0, -kInfinity), Vec2(0, 0), Vec2(4, 0)), kInfinity);
  EXPECT_EQ(distance_to_segment(Vec3(0, kInfinity, 0), Vec3(1, 1, 1), Vec3(1, 1, 1)), kInfinity);
}

TEST(Triangle, NearestPointIsInsideOnASideOrACorner) {
  const Vec3 a(0, 0, 0), b(4, 0, 0), c(0, 4, 0);
  EXPECT_EQ(closest_on_triangle({1, 1, 5}, a, b, c), Vec3(0.5, 0.25, 0.25));
  EXPECT_EQ(closest_on_triangle({2, -3, 0}, a, b, c), Vec3(0.5, 0.5, 0));
  EXPECT_EQ(closest_on_triangle({-3, 1, 0}, a, b, c), Vec3(0.75, 0, 0.25));
  EXPECT_EQ(closest_on_triangle({4, 4, 0}, a, b, c), Vec3(0, 0.5, 0.5));
  EXPECT_EQ(closest_on_triangle({-1, -1, 0}, a, b, c), Vec3(1, 0, 0));
  EXPECT_EQ(closest_on_triangle({9, 0, 0}, a, b, c), Vec3(0, 1, 0));
  EXPECT_EQ(closest_on_triangle({0, 9, 0}, a, b, c), Vec3(0, 0, 1));
  EXPECT_EQ(distance_to_triangle({1, 1, 5}, {a, b, c}), 5.0);
  EXPECT_EQ(area_of({a, b, c}), 8.0);
}

// The needle from (0, 0, 0) to (4, 0, 0), with its third corner at either end or between; (1, 3, 0) is 3 from it.
TEST(Triangle, WithoutAreaItIsItsLongestSide) {
  const Vec3 a(0, 0, 0), b(4, 0, 0), middle(2, 0, 0), p(1, 3, 0);
  for (const Triangle& t : {Triangle{a, b, middle},
                            {a, middle, b},
                            {middle, a, b},
                            {a, a, b},
                            {a, b, a},
                            {b, a, a},
                            {b, b, a},
                            {a, b, b},
                            {b, a, b}}) {
    EXPECT_EQ(distance_to_triangle(p, t), 3.0) << t[0] << "; " << t[1] << "; " << t[2];
    EXPECT_EQ(distance_to_triangle({7, 4, 0}, t), 5.0);
    EXPECT_EQ(area_of(t), 0.0);
  }
  EXPECT_EQ(distance_to_triangle({3, 4, 0}, {a, a, a}), 5.0);
}

// By hand: the ray from (1, 1) to the right meets the side from (3, 0) to (3, 2); a side counts with its lower end
// only, so a ray through a corner of a ring crosses once where the ring goes on upwards, and not where it turns back.
TEST(Ray, CrossesASideWithItsLowerEnd) {
  const Vec2 p(1, 1);
  EXPECT_TRUE(ray_crosses(p, {3, 0}, {3, 2}));
  EXPECT_TRUE(ray_crosses(p, {3, 2}, {3, 0}));
  EXPECT_FALSE(ray_crosses(p, {0, 0}, {0, 2})) << "behind";
  EXPECT_FALSE(ray_crosses(p, {2, 1}, {4, 1})) << "along";
  EXPECT_FALSE(ray_crosses(p, {3, 2}, {3, 4})) << "above";
  EXPECT_TRUE(ray_crosses(p, {3, 1}, {3, 2}));
  EXPECT_FALSE(ray_crosses(p, {3, 0}, {3, 1}));
  EXPECT_TRUE(ray_crosses(p, {0, 0}, {4, 2.1})) << "it passes at x = 1.9";
  EXPECT_FALSE(ray_crosses(p, {0, 0}, {4, 8})) << "it passes at x = 0.5";
}

// A face 100 mm long and 1e-9 mm high, as joining a T-junction leaves it.
TEST(Triangle, NeedleIsAsNearAsItsSide) {
  const Triangle needle{Vec3(0, 0, 0), Vec3(100, 0, 0), Vec3(37, 1e-9, 0)};
  for (double x = 0.0; x <= 100.0; x += 0.5) {
    EXPECT_NEAR(distance_to_triangle({x, 2, 1}, needle), std::sqrt(5.0), 1e-8) << x;
    const Vec3 w = closest_on_triangle({x, 2, 1}, needle[0], needle[1], needle[2]);
    EXPECT_NEAR(w.sum(), 1.0, 1e-12);
    EXPECT_GE(w.minCoeff(), 0.0);
  }
}

TEST(Triangle, LargeFarAndInfinite) {
  const Vec3 far(1e9, -1e9, 1e9);
  const Triangle small{far, far + Vec3(4, 0, 0), far + Vec3(0, 4, 0)};
  EXPECT_NEAR(distance_to_triangle(far + Vec3(1, 1, 5), small), 5.0, 1e-6);
  const Triangle large{Vec3(-1e9, -1e9, 0), Vec3(1e9, -1e9, 0), Vec3(0, 1e9, 0)};
  EXPECT_NEAR(distance_to_triangle({1, 1, 5}, large), 5.0, 1e-6);
  EXPECT_EQ(distance_to_triangle({kInfinity, 0, 0}, small), kInfinity);
  EXPECT_EQ(distance_to_triangle({0, kInfinity, -kInfinity}, small), kInfinity);
}

TEST(Angle, RoundingBeyondOneIsNoError) {
  const double over = 1.0 + 1e-15;
  EXPECT_EQ(angle_between(over * Vec3::UnitX(), Vec3::UnitX()), 0.0);
  EXPECT_EQ(angle_between(-over * Vec3::UnitX(), Vec3::UnitX()), std::numbers::pi);
  EXPECT_NEAR(angle_between(Vec3::UnitX(), Vec3::UnitY()), std::numbers::pi / 2.0, 1e-15);
}

}  // namespace
}  // namespace triskin::geometry

// SPDX-License-Identifier: GPL-3.0-or-later
// These tests use cases worked by hand and measure the gaps between all outlines.
#include "triskin/fabrication/nesting.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "support/strip_design.hpp"
#include "triskin/base/error.hpp"

namespace triskin::fabrication {
namespace {

using design::Vec2;

FlatIsland rectangle(double width_mm, double height_mm, const std::string& name = "R") {
  FlatIsland island;
  island.part_number = name;
  island.outline_mm = {{0, 0}, {width_mm, 0}, {width_mm, height_mm}, {0, height_mm}};
  return island;
}

FlatIsland strip(int modules) {
  const design::Design d = test::strip(modules);
  return flat_islands(d, sheet::sides_of(d)).front();
}

double to_side(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 d = b - a;
  return (p - a - std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) * d).norm();
}

bool is_inside(const Vec2& p, const std::vector<Vec2>& ring) {
  bool inside = false;
  for (std::size_t k = 0; k < ring.size(); ++k) {
    const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      inside = !inside;
  }
  return inside;
}

// The outlines must not cross; the distance is 0 if one lies inside the other.
double distance_between(const std::vector<Vec2>& a, const std::vector<Vec2>& b) {
  if (is_inside(a[0], b) || is_inside(b[0], a)) return 0.0;
  double least = 1e9;
  for (const auto& [one, other] : {std::pair(&a, &b), std::pair(&b, &a)}) {
    for (const Vec2& p : *one) {
      for (std::size_t k = 0; k < other->size(); ++k)
        least = std::min(least, to_side(p, (*other)[k], (*other)[(k + 1) % other->size()]));
    }
  }
  return least;
}

// 100 mm by 40 mm on a sheet of 120 mm lies flat, 1 mm from each edge, and is 40 mm high.
TEST(Nesting, OneRectangleLiesFlat) {
  SheetOptions options;
  options.width_mm = 120.0;
  const Nesting nesting = nest({rectangle(40, 100)}, options);
  ASSERT_EQ(nesting.used_mm.size(), 1U);
  EXPECT_GE(nesting.used_mm[0], 42.0);
  EXPECT_LE(nesting.used_mm[0], 42.1);
  EXPECT_NEAR(nesting.fill[0], 4000.0 / (120.0 * nesting.used_mm[0]), 1e-12);
}

// A sheet of 120 mm has room for only one square of 100 mm.
TEST(Nesting, WhatDoesNotFitBesideTheOthersGetsAnotherSheet) {
  SheetOptions options;
  options.width_mm = options.length_mm = 120.0;
  const Nesting nesting = nest({rectangle(100, 100), rectangle(100, 100), rectangle(100, 100)}, options);
  EXPECT_EQ(nesting.used_mm.size(), 3U);
  EXPECT_THROW((void)nest({rectangle(300, 30, "long")}, options), InputError);
  try {
    (void)nest({rectangle(300, 30, "long")}, options);
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("long of 300 × 30 mm"), std::string::npos) << e.what();
  }
}

void expect_gaps(const std::vector<FlatIsland>& islands, const Nesting& nesting, const SheetOptions& options) {
  ASSERT_EQ(nesting.places.size(), islands.size());
  std::vector<FlatIsland> laid;
  for (const NestedIsland& p : nesting.places) laid.push_back(on_sheet(islands[p.island], p));
  for (std::size_t a = 0; a < laid.size(); ++a) {
    EXPECT_EQ(nesting.places[a].island, a);
    const double end_mm = nesting.used_mm.at(static_cast<std::size_t>(nesting.places[a].sheet));
    EXPECT_LE(end_mm, options.length_mm);
    for (const Vec2& p : laid[a].outline_mm)
      EXPECT_GE(std::min({p.x(), p.y(), options.width_mm - p.x(), end_mm - p.y()}), options.gap_mm - 1e-9);
    for (std::size_t b = 0; b < a; ++b) {
      if (nesting.places[a].sheet != nesting.places[b].sheet) continue;
      EXPECT_GE(distance_between(laid[a].outline_mm, laid[b].outline_mm), options.gap_mm) << a << ' ' << b;
    }
  }
}

TEST(Nesting, IslandsKeepTheirGapAndTheSheet) {
  std::vector<FlatIsland> islands;
  for (const int modules : {1, 2, 3, 5, 6, 8, 9, 11, 4, 7}) islands.push_back(strip(modules));
  for (const double gap_mm : {0.0, 0.3, 1.0, 4.0}) {
    SheetOptions options;
    options.width_mm = 160.0;
    options.length_mm = 200.0;
    options.gap_mm = gap_mm;
    options.tries = 8;
    expect_gaps(islands, nest(islands, options), options);
  }
}

// Four rectangles of 60 mm by 40 mm around a square of 20 mm fill 100 mm by 100 mm, but only as a pinwheel, which
// laying one after the other as low as it goes does not find: it needs a second sheet.
TEST(Nesting, FindsTheOnlyLayoutThatFitsOneSheet) {
  std::vector<FlatIsland> islands(4, rectangle(60, 40));
  islands.push_back(rectangle(20, 20));
  SheetOptions options;
  options.width_mm = options.length_mm = 101.0;
  options.gap_mm = 0.0;
  options.tries = 1;
  EXPECT_EQ(nest(islands, options).used_mm.size(), 2U);
  options.tries = 60;
  const Nesting nesting = nest(islands, options);
  ASSERT_EQ(nesting.used_mm.size(), 1U);
  EXPECT_LE(nesting.used_mm[0], 101.0);
  expect_gaps(islands, nesting, options);
}

// Two right-angled trapezoids of 60 mm height whose parallel sides are 30 and 70 mm make a rectangle of 100 mm. With
// gaps of 1 mm across the slope and at the edges they need 100 + 1 / cos(slope) + 2 mm of the width.
TEST(Nesting, SlopesLieTogether) {
  FlatIsland trapezoid;
  trapezoid.part_number = "T";
  trapezoid.outline_mm = {{0, 0}, {70, 0}, {30, 60}, {0, 60}};
  SheetOptions options;
  options.width_mm = 102.0 + std::hypot(40.0, 60.0) / 60.0 + 0.1;
  const std::vector<FlatIsland> islands(2, trapezoid);
  const Nesting nesting = nest(islands, options);
  ASSERT_EQ(nesting.used_mm.size(), 1U);
  EXPECT_GE(nesting.used_mm[0], 62.0);
  EXPECT_LE(nesting.used_mm[0], 62.1);
  expect_gaps(islands, nesting, options);
}

// A hole of 60 mm takes a square of 50 mm, so that both need no more than the frame's 100 mm and two gaps.
TEST(Nesting, HolesTakeOtherIslands) {
  FlatIsland frame = rectangle(100, 100, "frame");
  frame.holes_mm = {{{20, 20}, {20, 80}, {80, 80}, {80, 20}}};
  const std::vector<FlatIsland> islands{frame, rectangle(50, 50)};
  SheetOptions options;
  options.width_mm = 110.0;
  const Nesting nesting = nest(islands, options);
  ASSERT_EQ(nesting.used_mm.size(), 1U);
  EXPECT_LE(nesting.used_mm[0], 102.1);
  const FlatIsland outer = on_sheet(frame, nesting.places[0]), inner = on_sheet(islands[1], nesting.places[1]);
  for (const Vec2& p : inner.outline_mm) EXPECT_TRUE(is_inside(p, outer.holes_mm[0]));
  for (const Vec2& p : inner.outline_mm) {
    for (std::size_t k = 0; k < 4; ++k)
      EXPECT_GE(to_side(p, outer.holes_mm[0][k], outer.holes_mm[0][(k + 1) % 4]), 1.0);
  }
}

// Strips of eight modules are parallelograms that fill a sheet except at its edges; more tries are never worse.
TEST(Nesting, StripsFillASheet) {
  const std::vector<FlatIsland> islands(12, strip(8));
  SheetOptions options;
  options.tries = 1;
  const Nesting once = nest(islands, options);
  options.tries = 20;
  const Nesting often = nest(islands, options);
  EXPECT_LE(often.used_mm.back(), once.used_mm.back());
  EXPECT_GE(often.fill[0], 0.75);
  EXPECT_EQ(nest(islands, options).used_mm, often.used_mm);
}

TEST(Nesting, DrawingsMoveWithTheirIsland) {
  const FlatIsland island = strip(3);
  NestedIsland place;
  place.angle_rad = std::numbers::pi / 2.0;
  place.shift_mm = {100.0, 10.0};
  const FlatIsland laid = on_sheet(island, place);
  ASSERT_FALSE(island.folds.empty());
  const Vec2 from = island.folds[0].from_mm;
  EXPECT_NEAR((laid.folds[0].from_mm - Vec2(100.0 - from.y(), 10.0 + from.x())).norm(), 0.0, 1e-9);
  EXPECT_NEAR(laid.marks[0].angle_rad - island.marks[0].angle_rad, std::numbers::pi / 2.0, 1e-12);
}

TEST(Nesting, RefusesSheetsOutOfRange) {
  SheetOptions options;
  options.width_mm = 20.0;
  EXPECT_THROW((void)nest({rectangle(10, 10)}, options), InputError);
  options = {};
  options.gap_mm = -1.0;
  EXPECT_THROW((void)nest({rectangle(10, 10)}, options), InputError);
}

}  // namespace
}  // namespace triskin::fabrication

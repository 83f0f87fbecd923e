// SPDX-License-Identifier: GPL-3.0-or-later
// The paper's Algorithm 1 as published: right without holes, wrong with a hole inside a tile.
#include "triskin/geometry/paper_algorithm.hpp"

#include <gtest/gtest.h>

#include "polygons.hpp"

namespace triskin::geometry {
namespace {

int miscounts(const Polygon& p, std::mt19937_64& random, int placements) {
  int wrong = 0;
  for (int k = 0; k < placements; ++k) {
    const Placement at{test::uniform(random, 0, 30), test::uniform(random, 0, 26), test::uniform(random, 0, 1.05)};
    const auto own = static_cast<int>(tiles_inside(p, at, 0.0).size());
    const int paper = paper_algorithm1(p, at, false);
    EXPECT_GE(paper, own) << "the paper's test may only count too many";
    wrong += paper != own ? 1 : 0;
  }
  return wrong;
}

TEST(PaperAlgorithm, agrees_where_no_hole_is_smaller_than_a_tile) {
  std::mt19937_64 random(31);
  const Polygon p = test::random_polygon(random, 30, 100.0, 0);
  EXPECT_EQ(miscounts(p, random, 100), 0);
}

TEST(PaperAlgorithm, inexact_and_exact_constructions_agree_on_a_generic_placement) {
  std::mt19937_64 random(32);
  const Polygon p = test::random_polygon(random, 20, 60.0, 0);
  const Placement at{3.3, 7.7, 0.4};
  EXPECT_EQ(paper_algorithm1(p, at, false), paper_algorithm1(p, at, true));
  EXPECT_GT(paper_algorithm1(p, at, true), 0);
}

// Two holes of about 3 mm: they lie inside one triangle, not across a side, for a good part of the placements.
TEST(PaperAlgorithm, miscounts_when_a_small_hole_lies_inside_a_tile) {
  std::mt19937_64 random(33);
  Polygon p = test::random_polygon(random, 20, 100.0, 0);
  p.holes = {{{-30, 10}, {-28, 13}, {-27, 10}}, {{30, -10}, {32, -7}, {33, -10}}};
  const int wrong = miscounts(normalize_polygon(p, "two holes"), random, 200);
  EXPECT_GT(wrong, 20);
  EXPECT_LT(wrong, 180);
}

}  // namespace
}  // namespace triskin::geometry

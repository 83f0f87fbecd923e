// SPDX-License-Identifier: GPL-3.0-or-later
// Tests R1 … R7 and Algorithms 2 and 3 of the paper: the numbers of placements, their places, and their order.
#include <gtest/gtest.h>

#include "polygons.hpp"
#include "triskin/placement/paper/heuristics.hpp"
#include "triskin/placement/placement.hpp"

namespace triskin::placement::paper {
namespace {

constexpr std::array kAll{Heuristic::kR1, Heuristic::kR2, Heuristic::kR3, Heuristic::kR4,
                          Heuristic::kR5, Heuristic::kR6, Heuristic::kR7};

std::vector<PivotedPlacement> produced(Heuristic heuristic, const Polygon& p, const HeuristicOptions& options = {}) {
  std::vector<PivotedPlacement> all;
  produce_placements(heuristic, p, options, [&](const PivotedPlacement& at) {
    all.push_back(at);
    return true;
  });
  return all;
}
Vec2 moved(const Polygon& p, const PivotedPlacement& at, int vertex) {
  const Placement m = without_pivot(p, at);
  return Eigen::Rotation2Dd(m.theta_rad) * p.outer[static_cast<std::size_t>(vertex)] + Vec2(m.x_mm, m.y_mm);
}
BestPlacement best(Heuristic heuristic, const Polygon& p, const HeuristicOptions& options = {}) {
  return algorithm2(p, std::array{heuristic}, options);
}
std::vector<int> values(Heuristic heuristic, const Polygon& p, const HeuristicOptions& options) {
  Algorithm1 algorithm1(p);
  std::vector<int> all;
  produce_placements(heuristic, p, options, [&](const PivotedPlacement& at) {
    all.push_back(algorithm1.count(at));
    return true;
  });
  return all;
}
// Makes a polygon like LH with 20 vertices and 57 cm².
Polygon like_lh(std::mt19937_64& random) {
  return test::random_polygon(random, 20, 57, 0);
}

TEST(PaperHeuristics, numbers_of_placements_are_those_of_the_formulas) {
  std::mt19937_64 random(1);
  for (std::int64_t n = 3; n <= 40; ++n) {
    const Polygon p = test::random_polygon(random, static_cast<int>(n), 60, 0);
    const auto size = [&](Heuristic h) { return static_cast<std::int64_t>(produced(h, p).size()); };
    ASSERT_EQ(size(Heuristic::kR2), 2 * n);
    ASSERT_EQ(size(Heuristic::kR3), n * (n - 1) / 2);
    ASSERT_EQ(size(Heuristic::kR4), n * n * (n - 1) / 2);
    for (const Heuristic h : kAll) ASSERT_EQ(size(h), placement_count(h, n)) << n;
  }
  EXPECT_EQ(placement_count(Heuristic::kR4, 80), 252'800);
  EXPECT_EQ(placement_count(Heuristic::kR4, 715), 182'507'325);
}

// The pivot lies on the node, and the other end of the edge on the line: up to rounding, far within the touching
// distance.
TEST(PaperHeuristics, r2_lays_both_edges_of_each_vertex_on_the_line) {
  std::mt19937_64 random(2);
  const Polygon p = test::random_polygon(random, 11, 60, 0);
  for (const int line : {0, 60, 300}) {
    const HeuristicOptions options{.line_deg = line, .node = {2, -3}};
    const Vec2 node = grid_point(2, -3), along(std::cos(line * M_PI / 180), std::sin(line * M_PI / 180));
    const auto all = produced(Heuristic::kR2, p, options);
    for (int k = 0; k < 11; ++k) {
      for (const int side : {0, 1}) {
        const PivotedPlacement& at = all[static_cast<std::size_t>(2 * k + side)];
        EXPECT_EQ(at.vertex, k);
        EXPECT_LT((moved(p, at, k) - node).norm(), 1e-11);
        const Vec2 other = moved(p, at, (k + (side == 0 ? 1 : 10)) % 11) - node;
        EXPECT_NEAR(other.dot(along), other.norm(), 1e-11);
      }
    }
  }
}

TEST(PaperHeuristics, r3_lays_each_pair_of_vertices_on_the_line) {
  std::mt19937_64 random(3);
  const Polygon p = test::random_polygon(random, 9, 60, 0);
  const auto all = produced(Heuristic::kR3, p);
  std::size_t n = 0;
  for (int i = 0; i < 9; ++i) {
    for (int j = i + 1; j < 9; ++j, ++n) {
      EXPECT_LT(moved(p, all[n], i).norm(), 1e-11);
      EXPECT_NEAR(moved(p, all[n], j).y(), 0.0, 1e-11);
      EXPECT_GT(moved(p, all[n], j).x(), 0.0);
    }
  }
}

// In Algorithm 3, line 9 names v_i as the pivot of a displacement that line 7 takes from v_k. Then v_k would not lie on
// the node, which is the purpose of the loop, so v_k is the pivot here.
TEST(PaperHeuristics, r4_puts_every_vertex_on_the_node_for_each_pair) {
  std::mt19937_64 random(4);
  const Polygon p = test::random_polygon(random, 7, 60, 0);
  const auto all = produced(Heuristic::kR4, p);
  std::size_t n = 0;
  int off_the_node = 0;
  for (int i = 0; i < 7; ++i) {
    for (int j = i + 1; j < 7; ++j) {
      for (int k = 0; k < 7; ++k, ++n) {
        EXPECT_LT(moved(p, all[n], k).norm(), 1e-11);
        EXPECT_NEAR((moved(p, all[n], j) - moved(p, all[n], i)).y(), 0.0, 1e-11);
        PivotedPlacement as_printed = all[n];
        as_printed.vertex = i;
        off_the_node += moved(p, as_printed, k).norm() > 1.0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(off_the_node, 80);
}

TEST(PaperHeuristics, random_ones_move_within_one_period_and_less_than_60_degrees) {
  std::mt19937_64 random(5);
  const Polygon p = test::random_polygon(random, 8, 60, 0);
  int up = 0, down = 0;
  const auto all = produced(Heuristic::kR1, p);
  for (const PivotedPlacement& at : all) {
    EXPECT_GE(at.theta_rad, 0.0);
    EXPECT_LT(at.theta_rad, M_PI / 3);
    const Vec2 q = moved(p, at, 0);
    const double v = q.y() / kHeight_mm, u = q.x() / kSide_mm - 0.5 * v;
    EXPECT_TRUE(u >= -1e-12 && u < 1 + 1e-12 && v >= -1e-12 && v < 1 + 1e-12);
    (u + v < 1 ? up : down) += 1;
  }
  EXPECT_EQ(all.size(), 1000u);
  EXPECT_NEAR(up, 500, 100);
  for (const PivotedPlacement& at : produced(Heuristic::kR6, p)) {
    EXPECT_LT(moved(p, at, at.vertex).norm(), 1e-11);
    EXPECT_TRUE(at.theta_rad >= 0.0 && at.theta_rad < M_PI / 3);
  }
  EXPECT_EQ(produced(Heuristic::kR1, p, {.draws = 17}).size(), 17u);
}

// Section IV-C claims that x and y within one module and an angle in [0°, 60°) cover everything. They cover half:
// this outline of three modules, 1 mm wider and with a thorn, holds them about one placement only, and there its first
// vertex, the end of the thorn, lies in a down module.
TEST(PaperHeuristics, one_module_and_60_degrees_are_half_of_all_placements) {
  Polygon p;
  p.outer = {{-8, -5}, {1, -1}, {61.7, -1}, {45.6, kHeight_mm + 1}, {14.4, kHeight_mm + 1}, {-1.9, -0.8}};
  p = test::moved(p, -20 * M_PI / 180, {0, 0});
  Algorithm1 algorithm1(p);
  int up = 0, down = 0;
  for (double v = 0.01; v < 1; v += 0.02) {
    for (double u = 0.01; u < 1; u += 0.02) {
      for (double degrees = 0; degrees < 60; degrees += 0.5) {
        const Vec2 by = Vec2(kSide_mm * (u + 0.5 * v), kHeight_mm * v) - p.outer[0];
        if (algorithm1.count({by.x(), by.y(), degrees * M_PI / 180, 0}) == 3) (u + v < 1 ? up : down) += 1;
      }
    }
  }
  EXPECT_EQ(up, 0);
  EXPECT_GT(down, 10);
}

TEST(PaperHeuristics, a_seed_gives_the_same_placements_again) {
  std::mt19937_64 random(6);
  const Polygon p = test::random_polygon(random, 8, 60, 0);
  const auto thetas = [&](std::uint64_t seed) {
    std::vector<double> all;
    for (const auto& at : produced(Heuristic::kR6, p, {.seed = seed})) all.push_back(at.theta_rad);
    return all;
  };
  EXPECT_EQ(thetas(7), thetas(7));
  EXPECT_NE(thetas(7), thetas(8));
}

// By the symmetry of the grid, turns by 60° about nodes and shifts from node to node map it onto itself.
TEST(PaperHeuristics, the_chosen_line_and_node_change_no_value) {
  std::mt19937_64 random(8);
  const Polygon p = like_lh(random);
  for (const Heuristic h : {Heuristic::kR2, Heuristic::kR3, Heuristic::kR4}) {
    const auto first = values(h, p, {});
    EXPECT_EQ(values(h, p, {.line_deg = 60, .node = {3, 5}}), first);
    EXPECT_EQ(values(h, p, {.line_deg = 300, .node = {-4, 1}}), first);
  }
}

// R4 contains the placements of R3 (k = i) and of R2 (pairs of neighbours, k at either end).
TEST(PaperHeuristics, r4_is_at_least_r3_and_r2) {
  std::mt19937_64 random(9);
  for (int n = 0; n < 12; ++n) {
    const Polygon p = test::random_polygon(random, 5 + 2 * n, 40.0 + 8 * n, 0);
    const int r4 = best(Heuristic::kR4, p).modules;
    EXPECT_GE(r4, best(Heuristic::kR3, p).modules);
    EXPECT_GE(r4, best(Heuristic::kR2, p).modules);
  }
}

TEST(PaperHeuristics, certified_search_is_at_least_r4_and_r4_at_least_r3) {
  std::mt19937_64 random(10);
  int beaten = 0;
  for (int n = 0; n < 10; ++n) {
    const Polygon p = test::random_polygon(random, 8 + 3 * n, 50.0 + 15 * n, 0);
    PlacementOptions options;
    options.largest_clearance = false;
    const PlacementResult certified = place(p, options);
    ASSERT_TRUE(certified.proved);
    const int r4 = best(Heuristic::kR4, p).modules;
    EXPECT_GE(certified.modules, r4);
    EXPECT_GE(r4, best(Heuristic::kR3, p).modules);
    beaten += certified.modules > r4 ? 1 : 0;
  }
  EXPECT_GT(beaten, 0);
}

// An exact union of modules holds them at one placement only, and all its contacts are by construction: R2, R3 and R4
// find it at any angle, but a scan of angles does not.
TEST(PaperHeuristics, exact_unions_of_modules_are_found_by_contacts) {
  for (const double angle : {0.0, 0.1, 0.77, 2.0}) {
    Polygon p;
    p.outer = {{0, 0}, {120, 0}, {60, 4 * kHeight_mm}};
    p = test::moved(p, angle, {5e5, -3e5});
    for (const Heuristic h : {Heuristic::kR2, Heuristic::kR3, Heuristic::kR4, Heuristic::kR5, Heuristic::kR7})
      EXPECT_EQ(best(h, p).modules, 16) << angle;
  }
}

// By Section VI, R5 gives the very placement of R2 if no random place is better, since it includes those of R2.
TEST(PaperHeuristics, r5_is_r2_where_no_random_place_is_better) {
  std::mt19937_64 random(12);
  int better = 0;
  for (int n = 0; n < 20; ++n) {
    const Polygon p = like_lh(random);
    const BestPlacement r2 = best(Heuristic::kR2, p), r5 = best(Heuristic::kR5, p);
    ASSERT_TRUE(r2.placement && r5.placement);
    if (r5.modules > r2.modules) {
      ++better;
      continue;
    }
    EXPECT_EQ(r5.modules, r2.modules);
    EXPECT_EQ(r5.placement->vertex, r2.placement->vertex);
    EXPECT_EQ(r5.placement->theta_rad, r2.placement->theta_rad);
    EXPECT_EQ(r5.patch, r2.patch);
  }
  EXPECT_LT(better, 10) << "so rarely that one polygon shows the same placement, as the paper's LH does";
}

TEST(PaperAlgorithm2, keeps_the_first_of_the_best_over_all_heuristics) {
  std::mt19937_64 random(13);
  const Polygon p = like_lh(random);
  const BestPlacement all = algorithm2(p, kAll);
  std::int64_t evaluations = 0;
  int most = 0;
  for (const Heuristic h : kAll) {
    const BestPlacement one = best(h, p);
    evaluations += one.evaluations;
    most = std::max(most, one.modules);
    EXPECT_EQ(one.patch.size(), static_cast<std::size_t>(one.modules));
  }
  EXPECT_EQ(all.modules, most);
  EXPECT_EQ(all.evaluations, evaluations);
  EXPECT_TRUE(all.complete);
  EXPECT_EQ(Algorithm1(p).patch(*all.placement), all.patch);
  Polygon small;
  small.outer = {{0, 0}, {20, 0}, {0, 20}};
  const BestPlacement none = algorithm2(small, kAll);
  EXPECT_FALSE(none.placement);
  EXPECT_EQ(none.modules, 0);
  EXPECT_FALSE(algorithm2(p, kAll, {}, {}, std::chrono::steady_clock::now()).complete);
}

TEST(PaperHeuristics, wrong_options_are_refused) {
  std::mt19937_64 random(14);
  const Polygon p = like_lh(random);
  EXPECT_THROW(produced(Heuristic::kR2, p, {.line_deg = 30}), std::invalid_argument);
  EXPECT_THROW(produced(Heuristic::kR1, p, {.draws = -1}), std::invalid_argument);
  EXPECT_THROW(produced(Heuristic::kR4, p, {.pair_step = 0}), std::invalid_argument);
}

TEST(PaperHeuristics, a_sample_takes_every_nth_pair) {
  std::mt19937_64 random(15);
  const Polygon p = like_lh(random);
  EXPECT_EQ(produced(Heuristic::kR4, p, {.pair_step = 19}).size(), 10u * 20u);  // There are 190 pairs.
}

}  // namespace
}  // namespace triskin::placement::paper

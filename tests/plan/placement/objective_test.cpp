// SPDX-License-Identifier: GPL-3.0-or-later
// Tests objectives other than the number of modules: connected modules, and weights by place.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "polygons.hpp"
#include "triskin/base/error.hpp"
#include "triskin/placement/placement.hpp"

namespace triskin::placement {
namespace {

PlacementResult connected(const Polygon& p, TileShape shape = TileShape::kTriangle) {
  PlacementOptions options;
  options.connected = true;
  options.shape = shape;
  return place(p, options);
}

PlacementResult weighted(const Polygon& p, const WeightMap& map) {
  PlacementOptions options;
  options.weights = std::make_shared<const WeightMap>(map);
  return place(p, options);
}

Polygon polygon_of(std::vector<Vec2> outer) {
  Polygon p;
  p.outer = std::move(outer);
  return normalize_polygon(p, "polygon");
}

// Decides by flood fill over shared sides, using the corners of the tiles.
bool hang_together(const std::vector<Tile>& tiles) {
  std::set<Tile> left(tiles.begin(), tiles.end());
  std::vector<Tile> next;
  const auto take = [&](const Tile& t) {
    if (left.erase(t) > 0) next.push_back(t);
  };
  if (!tiles.empty()) take(tiles[0]);
  while (!next.empty()) {
    const Tile t = next.back();
    next.pop_back();
    for (int k = 0; k < 3; ++k) take(across(t, k).tile);
  }
  return left.empty();
}

// Makes a hill of height 1 and width `width_mm` at `top`.
WeightMap hill(const Vec2& top, double width_mm) {
  const Vec2 origin(-400, -400);
  constexpr double step_mm = 20.0;
  std::vector<std::vector<double>> rows(41, std::vector<double>(41));
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t c = 0; c < rows[r].size(); ++c) {
      const Vec2 p = origin + step_mm * Vec2(static_cast<double>(c), static_cast<double>(r));
      rows[r][c] = std::exp(-(p - top).squaredNorm() / (2.0 * width_mm * width_mm));
    }
  }
  return {origin, step_mm, rows};
}

// Sums the weights of whole modules without gaps, or of those of `like`.
double weight_at(const Polygon& p, const WeightMap& map, const Placement& at, double tolerance_mm,
                 const PlacementOptions& like = {}, double pitch_mm = kSide_mm) {
  double sum = 0.0;
  const double c = std::cos(at.theta_rad), s = std::sin(at.theta_rad);
  for (const Tile& t : tiles_inside(p, at, tolerance_mm, like.gap_mm, like.corner_cut_mm)) {
    Vec2 center = Vec2::Zero();
    for (int k = 0; k < 3; ++k) {
      const auto [i, j] = tile_corner_index(t, k);
      center += pitch_mm / kSide_mm * grid_point(i, j) / 3.0;
    }
    const Vec2 q = center - Vec2(at.x_mm, at.y_mm);
    sum += map.at({c * q.x() + s * q.y(), -s * q.x() + c * q.y()}).value;
  }
  return sum;
}

// Two rooms of 100 mm × 90 mm are joined by a corridor of 16 mm, through which no module fits, so each room is a
// separate problem.
TEST(Connected, a_narrow_corridor_divides) {
  const Polygon both = polygon_of({{0, 0},
                                   {100, 0},
                                   {100, 42},
                                   {160, 42},
                                   {160, 0},
                                   {260, 0},
                                   {260, 90},
                                   {160, 90},
                                   {160, 58},
                                   {100, 58},
                                   {100, 90},
                                   {0, 90}});
  const PlacementResult one = connected(both), all = place(both);
  EXPECT_TRUE(one.proved);
  EXPECT_TRUE(hang_together(one.tiles));
  EXPECT_EQ(one.tiles.size(), static_cast<std::size_t>(one.modules));
  EXPECT_FALSE(hang_together(all.tiles));
  const PlacementResult room = place(polygon_of({{0, 0}, {100, 0}, {100, 90}, {0, 90}}));
  EXPECT_GE(one.modules, room.modules);  // The mouth of the corridor may have room for one more.
  EXPECT_LE(one.modules, room.modules + 1);
  EXPECT_LT(one.modules, all.modules);
}

// If the best placement is connected, the objective changes nothing; it never gives more, and no random motion has a
// larger component.
TEST(Connected, never_more_than_the_count_and_never_beaten) {
  std::mt19937_64 random(51);
  for (int k = 0; k < 5; ++k) {
    Polygon p;
    p.outer = test::star(random, 14, 70, 0.6);
    p = normalize_polygon(p, "star");
    const PlacementResult one = connected(p), all = place(p);
    ASSERT_TRUE(one.proved);
    EXPECT_TRUE(hang_together(one.tiles));
    EXPECT_LE(one.modules, all.modules);
    if (hang_together(all.tiles)) {
      EXPECT_EQ(one.modules, all.modules);
    }
    for (int n = 0; n < 2000; ++n) {
      const Placement at{test::uniform(random, 0, kSide_mm), test::uniform(random, 0, kHeight_mm),
                         test::uniform(random, 0, M_PI / 3)};
      const auto inside = tiles_inside(p, at, 0.0);
      if (static_cast<int>(inside.size()) > one.modules) {
        EXPECT_FALSE(hang_together(inside));
      }
    }
  }
}

TEST(Connected, hexagons_and_squares_by_their_own_sides) {
  std::vector<Vec2> disc;
  for (int k = 0; k < 48; ++k) disc.push_back(90.0 * Vec2(std::cos(k * M_PI / 24), std::sin(k * M_PI / 24)));
  for (const TileShape shape : {TileShape::kHexagon, TileShape::kSquare}) {
    PlacementOptions options;
    options.shape = shape;
    EXPECT_EQ(connected(polygon_of(disc), shape).modules, place(polygon_of(disc), options).modules);
  }
}

TEST(Weights, a_level_map_counts) {
  std::mt19937_64 random(52);
  const Polygon p = test::random_polygon(random, 12, 60, 0);
  const PlacementResult r = weighted(p, WeightMap({0, 0}, 10, {{2.5}}));
  EXPECT_TRUE(r.proved);
  EXPECT_EQ(r.modules, place(p).modules);
  EXPECT_NEAR(r.weight, 2.5 * r.modules, 1e-9);
}

TEST(Weights, found_where_the_hill_is_and_not_beaten) {
  std::mt19937_64 random(53);
  for (int k = 0; k < 4; ++k) {
    const Polygon p = test::random_polygon(random, 14, 60, 0);
    const WeightMap map = hill({test::uniform(random, -30, 30), 10}, 50);
    const PlacementResult r = weighted(p, map);
    ASSERT_TRUE(r.proved);
    EXPECT_NEAR(weight_at(p, map, r.placement, 1e-6), r.weight, 1e-9);
    EXPECT_LE(r.weight_bound, r.weight * (1.0 + 1.1e-5));
    EXPECT_GE(r.weight, weight_at(p, map, place(p).placement, 0.0) - 1e-9);
    for (int n = 0; n < 3000; ++n) {
      const Placement at{test::uniform(random, 0, kSide_mm), test::uniform(random, 0, kHeight_mm),
                         test::uniform(random, 0, M_PI / 3)};
      EXPECT_LE(weight_at(p, map, at, 0.0), r.weight_bound);
    }
    // Near the best placement a bound that is a little too small would show.
    for (int n = 0; n < 3000; ++n) {
      const double far = std::pow(10.0, test::uniform(random, -6, 0.5));
      Placement at = r.placement;
      at.x_mm += test::uniform(random, -far, far);
      at.y_mm += test::uniform(random, -far, far);
      at.theta_rad += test::uniform(random, -far, far) / 100.0;
      EXPECT_LE(weight_at(p, map, at, 0.0), r.weight_bound);
    }
  }
}

TEST(Weights, a_level_map_counts_other_shapes_too) {
  std::mt19937_64 random(56);
  const Polygon p = test::random_polygon(random, 12, 80, 0);
  for (const TileShape shape : {TileShape::kTriangle, TileShape::kHexagon, TileShape::kSquare}) {
    PlacementOptions options;
    options.shape = shape;
    options.gap_mm = 1.5;
    const int count = place(p, options).modules;
    options.weights = std::make_shared<const WeightMap>(WeightMap({0, 0}, 10, {{0.5}}));
    const PlacementResult r = place(p, options);
    EXPECT_TRUE(r.proved);
    EXPECT_NEAR(r.weight, 0.5 * count, 1e-9);
  }
}

// Random placements find tiles with gaps and cut corners too; the map is steep, so that a bound that forgot how a
// weight changes within a part of a slice would show.
TEST(Weights, of_cut_modules_with_gaps_are_not_beaten) {
  std::mt19937_64 random(57);
  for (int k = 0; k < 4; ++k) {
    const Polygon p = test::random_polygon(random, 14, 70, 0);
    const WeightMap map = hill({test::uniform(random, -40, 40), test::uniform(random, -40, 40)}, 25);
    PlacementOptions options;
    options.gap_mm = 1.0;
    options.corner_cut_mm = 3.0;
    options.weights = std::make_shared<const WeightMap>(map);
    const PlacementResult r = place(p, options);
    ASSERT_TRUE(r.proved);
    const auto weight = [&](const Placement& at, double tolerance_mm) {
      return weight_at(p, map, at, tolerance_mm, options, r.proof.pitch_mm);
    };
    EXPECT_NEAR(weight(r.placement, options.tolerance_mm), r.weight, 1e-9);
    for (int n = 0; n < 6000; ++n) {
      const double far = std::pow(10.0, test::uniform(random, -6, 1.5));
      const Placement at{r.placement.x_mm + test::uniform(random, -far, far),
                         r.placement.y_mm + test::uniform(random, -far, far),
                         r.placement.theta_rad + test::uniform(random, -far, far) / 30.0};
      EXPECT_LE(weight(at, 0.0), r.weight_bound);
    }
  }
}

TEST(Weights, move_with_the_polygon) {
  std::mt19937_64 random(54);
  const Polygon p = test::random_polygon(random, 12, 40, 0);
  const PlacementResult here = weighted(p, hill({20, 0}, 60)),
                        there = weighted(test::moved(p, 0.0, {100, -60}), hill({120, -60}, 60));
  EXPECT_NEAR(there.weight, here.weight,
              3e-5 * here.weight);  // The hills are sampled on different rasters, and each answer is exact to 1e-5.
}

TEST(WeightMap, keeps_planes_and_its_bounds) {
  const WeightMap plane({10, 20}, 5, {{0, 1, 2, 3, 4}, {2, 3, 4, 5, 6}, {4, 5, 6, 7, 8}, {6, 7, 8, 9, 10}});
  const auto jet = plane.at({20, 27.5});
  EXPECT_NEAR(jet.value, 2.0 + 3.0, 1e-12);  // The point is column 2, row 1.5.
  EXPECT_NEAR(jet.slope_per_mm.x(), 0.2, 1e-12);
  EXPECT_NEAR(jet.slope_per_mm.y(), 0.4, 1e-12);
  EXPECT_NEAR(plane.at({-1e6, -1e6}).value, 0.0, 1e-12);
  EXPECT_NEAR(plane.at({1e6, 1e6}).value, 10.0, 1e-12);
  const WeightMap map = hill({3, -4}, 40);
  std::mt19937_64 random(55);
  constexpr double d = 1e-3;
  for (int k = 0; k < 2000; ++k) {
    const Vec2 at(test::uniform(random, -450, 450), test::uniform(random, -450, 450));
    const auto here = map.at(at), east = map.at(at + Vec2(d, 0)), north = map.at(at + Vec2(0, d));
    EXPECT_LE(here.value, map.most());
    EXPECT_LE(here.slope_per_mm.norm(), map.max_slope_per_mm());
    EXPECT_NEAR((east.value - here.value) / d, here.slope_per_mm.x(), 0.5 * map.max_curvature_per_mm2() * d + 1e-12);
    EXPECT_NEAR((north.value - here.value) / d, here.slope_per_mm.y(), 0.5 * map.max_curvature_per_mm2() * d + 1e-12);
    EXPECT_LE((east.slope_per_mm - here.slope_per_mm).norm() / d, map.max_curvature_per_mm2() * (1.0 + 1e-6));
    EXPECT_LE(here.near_curvature_per_mm2, map.max_curvature_per_mm2());
    // Between two points within a step the slope changes by no more than the curvature near the first one allows.
    const double angle = test::uniform(random, 0, 2.0 * M_PI), far = test::uniform(random, 0, map.step_mm());
    const auto there = map.at(at + far * Vec2(std::cos(angle), std::sin(angle)));
    EXPECT_LE((there.slope_per_mm - here.slope_per_mm).norm(),
              here.near_curvature_per_mm2 * far * (1.0 + 1e-9) + 1e-15);
  }
}

// Two triangles of a square have the weights 0, 10, 20, 10 at its corners, which is the plane (x + y) · 0.1; beyond
// the square the weight is that of the nearest point.
TEST(WeightMap, from_a_flat_mesh_with_a_weight_at_each_vertex) {
  const std::vector<WeightMap::Vertex> vertices{{{0, 0}, 0}, {{100, 0}, 10}, {{100, 100}, 20}, {{0, 100}, 10}};
  const WeightMap map = WeightMap::of_mesh(vertices, {{0, 1, 2}, {0, 2, 3}}, 5.0);
  for (const Vec2& at : {Vec2(50, 50), Vec2(20, 70), Vec2(81, 33)})
    EXPECT_NEAR(map.at(at).value, 0.1 * (at.x() + at.y()), 1e-9);
  EXPECT_NEAR(map.at({50, -300}).value, 5.0, 0.1);
}

TEST(WeightInput, names_row_column_and_remedy) {
  const auto message = [](auto&& make) -> std::string {
    try {
      make();
    } catch (const InputError& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_THAT(message([] { WeightMap({0, 0}, 10, {{1, 2}, {3}}); }),
              testing::HasSubstr("row 1 has 1 values, row 0 has 2"));
  EXPECT_THAT(message([] { WeightMap({0, 0}, 10, {{1, 2}, {3, -1}}); }),
              testing::HasSubstr("row 1, column 1: -1 must be in 0"));
  EXPECT_THAT(message([] { WeightMap({0, 0}, 0, {{1}}); }), testing::HasSubstr("step 0 mm must be positive"));
  EXPECT_THAT(message([] { WeightMap({0, 0}, 1, {}); }), testing::HasSubstr("at least one row"));
  EXPECT_THAT(message([] { (void)WeightMap::of_mesh({{{0, 0}, 1}, {{1, 0}, 1}, {{0, 1}, 1}}, {{0, 1, 3}}, 5); }),
              testing::HasSubstr("face 0: there is no vertex 3"));
  PlacementOptions options;
  options.connected = true;
  options.method = PlacementMethod::kR4;
  EXPECT_THAT(message([&] { (void)place(polygon_of({{0, 0}, {90, 0}, {0, 90}}), options); }),
              testing::HasSubstr("only method bnb"));
  const auto file = std::filesystem::temp_directory_path() / "triskin_weights_test.json";
  std::ofstream(file) << R"({"origin_mm": [0, 0], "rows": [[1]]})";
  EXPECT_THAT(message([&] { (void)read_weight_map(file); }),
              testing::AllOf(testing::HasSubstr(file.string()), testing::HasSubstr("step_mm")));
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace triskin::placement

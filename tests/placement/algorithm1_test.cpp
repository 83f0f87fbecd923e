// SPDX-License-Identifier: GPL-3.0-or-later
// Algorithm 1 against brute force in exact arithmetic, tile by tile; and the paper's three-sides test where it is
// wrong.
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_2.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "polygons.hpp"
#include "triskin/geometry/placement.hpp"

namespace triskin::geometry {
namespace {

using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
using Point = Exact::Point_2;

struct ExactPolygon {
  CGAL::Polygon_2<Exact> outer;
  std::vector<CGAL::Polygon_2<Exact>> holes;
};

ExactPolygon exact(const Polygon& p, const Placement& at) {
  const double c = std::cos(at.theta_rad), s = std::sin(at.theta_rad);
  const auto ring = [&](const std::vector<Vec2>& points) {
    CGAL::Polygon_2<Exact> r;
    for (const Vec2& v : points) r.push_back(Point(c * v.x() - s * v.y() + at.x_mm, s * v.x() + c * v.y() + at.y_mm));
    return r;
  };
  ExactPolygon e{ring(p.outer), {}};
  for (const auto& hole : p.holes) e.holes.push_back(ring(hole));
  return e;
}

// A tile lies inside when no edge of any ring touches it, its centre is in the outer ring and in no hole.
bool tile_inside(const ExactPolygon& p, const Tile& tile) {
  std::array<Point, 3> t;
  for (int k = 0; k < 3; ++k) {
    const auto [i, j] = tile_corner_index(tile, k);
    const Vec2 q = grid_point(i, j);
    t[static_cast<std::size_t>(k)] = Point(q.x(), q.y());
  }
  const Exact::Triangle_2 triangle(t[0], t[1], t[2]);
  const auto touches = [&](const CGAL::Polygon_2<Exact>& ring) {
    return std::any_of(ring.edges_begin(), ring.edges_end(),
                       [&](const auto& e) { return CGAL::do_intersect(triangle, e); });
  };
  const Point center = CGAL::centroid(t[0], t[1], t[2]);
  if (touches(p.outer) || !p.outer.has_on_bounded_side(center)) return false;
  return std::ranges::none_of(p.holes, [&](const auto& h) { return touches(h) || h.has_on_bounded_side(center); });
}

std::vector<Tile> brute_force(const ExactPolygon& p) {
  const auto box = p.outer.bbox();
  std::vector<Tile> tiles;
  for (int j = static_cast<int>(std::floor(box.ymin() / kHeight_mm)) - 1; j * kHeight_mm < box.ymax(); ++j) {
    const int first = static_cast<int>(std::floor(box.xmin() / kSide_mm - 0.5 * j)) - 2;
    for (int i = first; kSide_mm * (i + 0.5 * j) < box.xmax(); ++i) {
      for (const bool up : {true, false}) {
        if (tile_inside(p, {i, j, up})) tiles.push_back({i, j, up});
      }
    }
  }
  std::ranges::sort(tiles);
  return tiles;
}

TEST(Algorithm1, equals_brute_force_on_2000_placements_of_10_polygons_with_holes) {
  constexpr std::uint64_t kSeed = 20130101;
  std::mt19937_64 random(kSeed);
  int with_modules = 0;
  for (int polygon = 0; polygon < 10; ++polygon) {
    const Polygon p = test::random_polygon(random, 8 + 4 * polygon, 40.0 + 12.0 * polygon, polygon % 4);
    for (int k = 0; k < 200; ++k) {
      const Placement at{test::uniform(random, -100, 100), test::uniform(random, -100, 100),
                         test::uniform(random, -4, 4)};
      const auto tiles = tiles_inside(p, at, 0.0);
      ASSERT_EQ(tiles, brute_force(exact(p, at))) << "seed " << kSeed << " polygon " << polygon << " placement " << k;
      with_modules += tiles.empty() ? 0 : 1;
    }
  }
  EXPECT_GT(with_modules, 1800);
}

// The paper asks only whether the three sides cross the polygon: a hole within a tile escapes it.
TEST(Algorithm1, a_hole_inside_one_tile_removes_that_tile) {
  Polygon p;
  p.outer = {{-100, -100}, {100, -100}, {100, 100}, {-100, 100}};
  const Placement at{};
  const std::size_t without = tiles_inside(normalize_polygon(p, "square"), at, 0.0).size();
  p.holes = {{{14, 8}, {16, 8}, {15, 10}}};  // around the centre (15, 8.66) of the up tile (0, 0)
  const auto with = tiles_inside(normalize_polygon(p, "square"), at, 0.0);
  EXPECT_EQ(with.size(), without - 1);
  EXPECT_EQ(std::ranges::count(with, Tile{0, 0, true}), 0);
}

}  // namespace
}  // namespace triskin::geometry

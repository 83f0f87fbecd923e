// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the paper's rules for touching (Definitions 5 to 8, Conditions 1 and 2, Theorem 2), worked by hand. Coordinates
// are those of nodes: (i, j) is a*i*(1, 0) + a*j*(½, √3/2); the up module of cell (i, j) has the corners (i, j), (i
// + 1, j), (i, j + 1), the down module (i + 1, j), (i + 1, j + 1), (i, j + 1).
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_2.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "polygons.hpp"
#include "triskin/placement/paper/algorithm1.hpp"

namespace triskin::placement::paper {
namespace {

constexpr CgalUse kInexact{}, kExact{.exact_constructions = true};

using Point = std::array<double, 2>;

std::vector<Vec2> ring(const std::vector<Point>& nodes) {
  std::vector<Vec2> r;
  for (const auto& [u, v] : nodes) r.emplace_back(kSide_mm * (u + 0.5 * v), kHeight_mm * v);
  return r;
}
Polygon polygon(const std::vector<Point>& outer, const std::vector<std::vector<Point>>& holes = {}) {
  Polygon p;
  p.outer = ring(outer);
  for (const auto& hole : holes) p.holes.push_back(ring(hole));
  return normalize_polygon(p, "nodes");
}

// Returns the patch of all three programs, which must agree. The polygon is also placed by another pivot and from
// another angle.
std::vector<Tile> patch(const Polygon& p, const Algorithm1Options& options = {}) {
  const std::vector<Tile> tiles = Algorithm1(p, options).patch({});
  EXPECT_EQ(algorithm1_cgal(p, {}, kInexact, options), tiles);
  EXPECT_EQ(algorithm1_cgal(p, {}, kExact, options), tiles);
  for (const double angle : {0.3, 1.0, 2.5}) {
    Polygon turned = p;
    const auto turn = [&](Vec2& v) { v = Eigen::Rotation2Dd(angle) * v + Vec2(1234.5, -678.9); };
    std::ranges::for_each(turned.outer, turn);
    for (auto& hole : turned.holes) std::ranges::for_each(hole, turn);
    const Vec2 back = p.outer[1] - turned.outer[1];
    EXPECT_EQ(Algorithm1(turned, options).patch({back.x(), back.y(), -angle, 1}), tiles) << "turned by " << angle;
  }
  return tiles;
}
std::size_t count(const Polygon& p, ContainedSides sides = ContainedSides::kDefinition5) {
  return patch(p, {.sides = sides}).size();
}
constexpr auto kListing = ContainedSides::kContainmentInterval;
constexpr auto kLetter = ContainedSides::kTheorem2;

// This is Condition 1.
TEST(PaperTouching, module_inside_without_contact) {
  EXPECT_EQ(patch(polygon({{-0.2, -0.2}, {1.5, -0.2}, {-0.2, 1.5}})), (std::vector<Tile>{{0, 0, true}}));
}

// By Condition 2 all sides lie on the outline, touched from inside. The listing considers intervals only, but every
// line of the outline has touching intersections only, so it finds nothing.
TEST(PaperTouching, module_that_is_the_polygon) {
  const Polygon p = polygon({{0, 0}, {1, 0}, {0, 1}});
  EXPECT_EQ(patch(p), (std::vector<Tile>{{0, 0, true}}));
  EXPECT_EQ(count(p, kLetter), 1u);
  EXPECT_EQ(count(p, kListing), 0u);
}

TEST(PaperTouching, triangle_of_four_modules) {
  const Polygon p = polygon({{0, 0}, {2, 0}, {0, 2}});
  EXPECT_EQ(patch(p), (std::vector<Tile>{{0, 0, false}, {0, 0, true}, {0, 1, true}, {1, 0, true}}));
  EXPECT_EQ(patch(p, {.sides = kListing}), (std::vector<Tile>{{0, 0, false}}));
}

TEST(PaperTouching, hexagon_of_six_modules) {
  const Polygon p = polygon({{1, 0}, {2, 0}, {2, 1}, {1, 2}, {0, 2}, {0, 1}});
  EXPECT_EQ(count(p), 6u);
  EXPECT_EQ(count(p, kListing), 0u);  // Each has two sides inside and one on the outline.
}

// A module outside shares its side with the polygon: that side is contained, the others are not.
TEST(PaperTouching, module_touched_from_outside) {
  const auto tiles = patch(polygon({{0, 0}, {1, 0}, {0, 1}}));
  EXPECT_EQ(std::ranges::count(tiles, Tile{0, 0, false}), 0);
}

// The outline has a vertex in the middle of a module's side, so no edge has the whole side.
TEST(PaperTouching, vertex_in_the_middle_of_a_side) {
  const Polygon p = polygon({{0, 0}, {0.5, 0}, {1, 0}, {0, 1}});
  EXPECT_EQ(count(p), 1u);
  EXPECT_EQ(count(p, kLetter), 0u);
}

// Figure 9, right: the outline runs on the line from (1, 0) to (1.5, 0), which is one cutting intersection: below the
// line the polygon is left of it, above it too. The interval ends there: the side from 0 to 1 is contained, for the
// modules on both sides of the line, that from 1 to 2 is not.
TEST(PaperTouching, cutting_stretch_ends_an_interval) {
  const Polygon p = polygon({{-1.5, -1}, {2, -1}, {1, 0}, {1.5, 0}, {0.5, 1}, {-1.5, 1}});
  const auto tiles = patch(p);
  EXPECT_EQ(std::ranges::count(tiles, Tile{0, 0, true}), 1);
  EXPECT_EQ(std::ranges::count(tiles, Tile{0, -1, false}), 1);
  EXPECT_EQ(std::ranges::count(tiles, Tile{1, 0, true}), 0);
  EXPECT_EQ(std::ranges::count(tiles, Tile{1, -1, false}), 0);
  EXPECT_EQ(tiles, patch(p, {.sides = kLetter}));
}

// If the stretch is from (0.5, 0) to (1.5, 0), the side from 0 to 1 lies half in the interval, half on the edge. It is
// in cl(P), so the module above it is contained; by the literal Theorem 2 it is not.
TEST(PaperTouching, side_half_in_an_interval_half_on_an_edge) {
  const Polygon p = polygon({{-1.5, -1}, {1.5, -1}, {0.5, 0}, {1.5, 0}, {1.5, 1.2}, {-1.5, 1.2}});
  EXPECT_EQ(std::ranges::count(patch(p), Tile{0, 0, true}), 1);
  EXPECT_EQ(std::ranges::count(patch(p, {.sides = kLetter}), Tile{0, 0, true}), 0);
}

// Figure 10: a notch from above has a tip, or a flat bottom, that touches the line from above. The line keeps its one
// interval: modules below remain, those that the notch pierces do not (Figure 7).
TEST(PaperTouching, notch_that_touches_a_line) {
  const Polygon tip = polygon({{-1, -1.2}, {3.1, -1.2}, {3.1, 2.2}, {1.6, 2.2}, {0.5, 0}, {0.4, 2.2}, {-3, 2.2}});
  EXPECT_EQ(std::ranges::count(patch(tip), Tile{0, -1, false}), 1);  // The module is below the side (0, 0)–(1, 0).
  EXPECT_EQ(std::ranges::count(patch(tip), Tile{0, 0, true}), 0);
  EXPECT_EQ(patch(tip), patch(tip, {.sides = kListing}));
  const Polygon flat = polygon({{-1, -1}, {3, -1}, {3, 2}, {1.6, 2}, {0.9, 0}, {0.3, 0}, {-0.6, 2}, {-3, 2}});
  EXPECT_EQ(std::ranges::count(patch(flat), Tile{0, -1, false}), 1);
  EXPECT_EQ(std::ranges::count(patch(flat), Tile{0, 0, true}), 0);
}

// A contact of type 2 (Definition 9) is a vertex against a side. Deeper than the touching distance it pierces.
TEST(PaperTouching, tip_a_hair_over_the_line) {
  const auto with_tip = [](double over_mm) {
    return polygon({{-1, -1}, {3, -1}, {3, 2}, {1.6, 2}, {0.5, -over_mm / kHeight_mm}, {0.4, 2}, {-3, 2}});
  };
  EXPECT_EQ(std::ranges::count(patch(with_tip(4e-7)), Tile{0, -1, false}), 1);
  EXPECT_EQ(std::ranges::count(patch(with_tip(6e-7)), Tile{0, -1, false}), 0);
  EXPECT_EQ(std::ranges::count(patch(with_tip(-6e-7)), Tile{0, -1, false}), 1);
  EXPECT_EQ(std::ranges::count(patch(with_tip(6e-7), {.touch_mm = 1e-6}), Tile{0, -1, false}), 1);
}

// A contact of type 1 is the node (1, 0) against an edge that leans less than the side (1, 0)-(0, 1). The module
// touches it from inside; an edge that leans more cuts the side; one that leans as much has the side on it. The
// touching distance, 1.7e-8 sides, is measured along the lines.
TEST(PaperTouching, node_against_an_edge) {
  const auto cut_at = [](double u, double lean) {  // The edge meets the line v = 0 at u.
    return polygon({{-0.5, -0.5}, {u + 0.5 * lean, -0.5}, {u - 1.5 * lean, 1.5}, {-2.5, 1.5}});
  };
  EXPECT_EQ(std::ranges::count(patch(cut_at(1.0, 0.5)), Tile{0, 0, true}), 1);
  EXPECT_EQ(std::ranges::count(patch(cut_at(1.0 - 5e-9, 0.5)), Tile{0, 0, true}), 1);
  EXPECT_EQ(std::ranges::count(patch(cut_at(1.0 - 1e-6, 0.5)), Tile{0, 0, true}), 0);
  EXPECT_EQ(std::ranges::count(patch(cut_at(1.0, 1.5)), Tile{0, 0, true}), 0);
  EXPECT_EQ(std::ranges::count(patch(cut_at(1.0, 1.0)), Tile{0, 0, true}), 1);
  EXPECT_EQ(std::ranges::count(patch(cut_at(1.0 - 1e-8, 1.0)), Tile{0, 0, true}), 1);
  EXPECT_EQ(std::ranges::count(patch(cut_at(1.0 - 1e-6, 1.0)), Tile{0, 0, true}), 0);
}

// Figure 6 has at the top one module and no other node, at the bottom nodes but no module.
TEST(PaperTouching, nodes_inside_say_nothing_of_modules) {
  EXPECT_EQ(count(polygon({{-0.1, -0.1}, {1.2, -0.1}, {-0.1, 1.2}})), 1u);
  EXPECT_EQ(count(polygon({{-0.2, -0.1}, {3.3, -0.1}, {3.1, 0.1}, {-0.4, 0.1}})), 0u);  // Four nodes lie in a strip.
}

// Figure 7 has all nodes inside, but a side is pierced.
TEST(PaperTouching, pierced_module_is_not_contained) {
  EXPECT_EQ(count(polygon({{-0.3, -0.3}, {0.4, -0.3}, {0.45, 0.2}, {0.5, -0.3}, {1.7, -0.3}, {-0.3, 1.7}})), 0u);
}

// The rule as written is wrong here: a hole that is a module has all three sides of that module on edges.
TEST(PaperTouching, hole_that_is_a_module) {
  const std::vector<Point> outer{{-1, -1}, {3, -1}, {-1, 3}};
  const auto whole = patch(polygon(outer));
  EXPECT_EQ(whole.size(), 16u);
  const Polygon p = polygon(outer, {{{0, 0}, {1, 0}, {0, 1}}});
  EXPECT_EQ(patch(p), whole);
  auto amended = whole;
  std::erase(amended, Tile{0, 0, true});
  EXPECT_EQ(patch(p, {.reject_pierced = true}), amended);
}

// A hole of the size of a module touches one side, and another crosses sides: with the amendment both are right.
TEST(PaperTouching, holes_that_touch_or_cross_sides) {
  const std::vector<Point> outer{{-1, -1}, {3, -1}, {-1, 3}};
  const Polygon touching = polygon(outer, {{{0.2, 0}, {0.6, 0}, {0.2, 0.5}}});
  EXPECT_EQ(patch(touching).size(), 16u);
  EXPECT_EQ(patch(touching, {.reject_pierced = true}).size(), 15u);
  const Polygon crossing = polygon(outer, {{{0.2, -0.1}, {0.6, -0.1}, {0.2, 0.5}}});
  EXPECT_EQ(patch(crossing).size(), 14u);
  EXPECT_EQ(patch(crossing, {.reject_pierced = true}).size(), 14u);
}

// No simple polygon has a crack of zero width: across a side it cuts that side, but from a node into a module it is not
// seen.
TEST(PaperTouching, cracks_of_zero_width) {
  const Polygon across = polygon({{-1, -1}, {0.5, -1}, {0.5, -0.5}, {0.5, -1}, {3, -1}, {-1, 3}});
  EXPECT_EQ(patch(across).size(), 15u);
  const Polygon from_node = polygon({{-1, -1}, {0, -1}, {0.3, -0.6}, {0, -1}, {3, -1}, {-1, 3}});
  EXPECT_EQ(patch(from_node).size(), 16u);
  EXPECT_EQ(patch(from_node, {.reject_pierced = true}).size(), 15u);
}

// Outlines with vertices on thirds of the grid have many exact contacts, which are counted by exact predicates on those
// numbers.
namespace exact {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Ring = CGAL::Polygon_2<Kernel>;

Ring star(std::mt19937_64& random) {
  constexpr int kVertices = 14;
  std::vector<Kernel::Point_2> points;
  for (int k = 0; k < kVertices; ++k) {
    const double angle = 2 * M_PI * k / kVertices, radius = 3 * test::uniform(random, 1.0, 4.0);
    const double v = std::round(radius * std::sin(angle) / 0.87), u = std::round(radius * std::cos(angle) - 0.5 * v);
    points.emplace_back(u, v);  // Modules have corners at multiples of 3 of these units.
  }
  return Ring(points.begin(), points.end());
}

Ring simple_star(std::mt19937_64& random) {
  Ring r = star(random);
  while (!r.is_simple() || r.orientation() != CGAL::COUNTERCLOCKWISE) r = star(random);
  return r;
}

// Returns true if no edge meets the open tile, and its centre is inside.
bool inside(const Ring& r, const Tile& tile) {
  std::array<Kernel::Point_2, 3> t;
  for (int k = 0; k < 3; ++k) {
    const auto [i, j] = tile_corner_index(tile, k);
    t[static_cast<std::size_t>(k)] = {3.0 * i, 3.0 * j};
  }
  for (auto e = r.edges_begin(); e != r.edges_end(); ++e) {
    bool apart = false;
    int left = 0, right = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      apart = apart || (!CGAL::left_turn(t[k], t[(k + 1) % 3], e->source()) &&
                        !CGAL::left_turn(t[k], t[(k + 1) % 3], e->target()));
      left += CGAL::left_turn(e->source(), e->target(), t[k]) ? 1 : 0;
      right += CGAL::right_turn(e->source(), e->target(), t[k]) ? 1 : 0;
    }
    if (!apart && left > 0 && right > 0) return false;
  }
  // The centre is exact, because thirds of whole numbers are whole in units of thirds.
  return r.has_on_bounded_side({3.0 * tile.i + (tile.up ? 1 : 2), 3.0 * tile.j + (tile.up ? 1 : 2)});
}

}  // namespace exact

TEST(PaperTouching, equals_an_exact_count_on_300_outlines_with_many_contacts) {
  constexpr std::uint64_t kSeed = 99;
  std::mt19937_64 random(kSeed);
  int modules = 0, listed = 0;
  for (int n = 0; n < 300; ++n) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << " outline " << n);
    const exact::Ring r = exact::simple_star(random);
    std::vector<Point> nodes;
    for (const auto& p : r) nodes.push_back({p.x() / 3, p.y() / 3});
    std::vector<Tile> expected;
    for (int i = -12; i < 12; ++i) {
      for (int j = -12; j < 12; ++j) {
        for (const bool up : {false, true}) {
          if (exact::inside(r, {i, j, up})) expected.push_back({i, j, up});
        }
      }
    }
    Polygon p;
    p.outer = ring(nodes);  // The ring is used directly: normalizing would drop nothing here.
    ASSERT_EQ(patch(p), expected);
    modules += static_cast<int>(expected.size());
    listed += static_cast<int>(Algorithm1(p, {.sides = kListing}).count({}));
  }
  EXPECT_GT(modules, 1000);
  EXPECT_LT(listed, modules - 100) << "edges on lines are what the listing leaves out";
}

}  // namespace
}  // namespace triskin::placement::paper

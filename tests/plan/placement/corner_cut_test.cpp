// SPDX-License-Identifier: GPL-3.0-or-later
// Tests modules with corners cut off: what lies inside, tile by tile, against exact arithmetic; the certified search
// against brute force and against the checker of proofs, which has its own numbers for the hexagon.
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_2.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "polygons.hpp"
#include "scans.hpp"
#include "triskin/base/error.hpp"
#include "triskin/check/placement_proof.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/placement/placement.hpp"

namespace triskin::placement {
namespace {

using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
using Point = Exact::Point_2;
using Ring = CGAL::Polygon_2<Exact>;

// A tile that touches the outline counts as cut, so this is for generic placements.
class ExactCutCount {
 public:
  ExactCutCount(const Polygon& p, const Placement& at, double cut_mm) : cut_mm_(cut_mm) {
    rings_.push_back(moved(p.outer, at));
    for (const auto& hole : p.holes) rings_.push_back(moved(hole, at));
  }

  [[nodiscard]] std::vector<Tile> tiles() const {
    const auto box = rings_.front().bbox();
    std::vector<Tile> found;
    for (int j = static_cast<int>(std::floor(box.ymin() / kHeight_mm)) - 2; (j - 1) * kHeight_mm < box.ymax(); ++j) {
      const int first = static_cast<int>(std::floor(box.xmin() / kSide_mm - 0.5 * j)) - 3;
      for (int i = first; kSide_mm * (i + 0.5 * j) < box.xmax() + kSide_mm; ++i) {
        for (const bool up : {true, false}) {
          if (inside({i, j, up})) found.push_back({i, j, up});
        }
      }
    }
    std::ranges::sort(found);
    return found;
  }

 private:
  static Ring moved(const std::vector<Vec2>& points, const Placement& at) {
    const double c = std::cos(at.theta_rad), s = std::sin(at.theta_rad);
    Ring ring;
    for (const Vec2& v : points)
      ring.push_back(Point(c * v.x() - s * v.y() + at.x_mm, s * v.x() + c * v.y() + at.y_mm));
    return ring;
  }

  static CGAL::Bbox_2 around(const Point& p, double reach) {
    const double x = CGAL::to_double(p.x()), y = CGAL::to_double(p.y());
    return {x - reach, y - reach, x + reach, y + reach};
  }

  // Returns six points by exact division of the triangle's sides.
  [[nodiscard]] std::vector<Point> hexagon(const Tile& tile) const {
    std::array<Point, 3> corner;
    for (int k = 0; k < 3; ++k) {
      const auto [i, j] = tile_corner_index(tile, k);
      const Vec2 q = grid_point(i, j);
      corner[static_cast<std::size_t>(k)] = Point(q.x(), q.y());
    }
    const Exact::FT part = Exact::FT(cut_mm_) / 30;
    std::vector<Point> points;
    for (std::size_t k = 0; k < 3; ++k) {
      const Point &a = corner[k], &b = corner[(k + 1) % 3];
      points.push_back(a + part * (b - a));
      points.push_back(b + part * (a - b));
    }
    return points;
  }

  [[nodiscard]] bool inside(const Tile& tile) const {
    const std::vector<Point> h = hexagon(tile);
    const Point center = CGAL::centroid(h[0], h[2], h[4]);
    const auto touches = [&](const Exact::Segment_2& edge) {
      if (!CGAL::do_overlap(edge.bbox(), around(center, 20.0))) return false;
      for (std::size_t k = 1; k + 1 < h.size(); ++k) {
        if (CGAL::do_intersect(Exact::Triangle_2(h[0], h[k], h[k + 1]), edge)) return true;
      }
      return false;
    };
    for (std::size_t r = 0; r < rings_.size(); ++r) {
      if (rings_[r].has_on_bounded_side(center) != (r == 0)) return false;
    }
    for (const Ring& ring : rings_) {
      if (std::any_of(ring.edges_begin(), ring.edges_end(), touches)) return false;
    }
    return true;
  }

  double cut_mm_;
  std::vector<Ring> rings_;
};

TEST(CornerCut, tiles_inside_equal_exact_arithmetic_on_480_placements) {
  constexpr std::uint64_t kSeed = 20130301;
  std::mt19937_64 random(kSeed);
  int more_than_whole = 0;
  for (int polygon = 0; polygon < 8; ++polygon) {
    const Polygon p = test::random_polygon(random, 8 + 4 * polygon, 40.0 + 12.0 * polygon, polygon % 4);
    for (int k = 0; k < 60; ++k) {
      const double cut_mm = std::array{0.5, 3.0, 6.9}[static_cast<std::size_t>(k % 3)];
      const Placement at{test::uniform(random, -100, 100), test::uniform(random, -100, 100),
                         test::uniform(random, -4, 4)};
      const auto tiles = tiles_inside(p, at, 0.0, 0.0, cut_mm);
      ASSERT_EQ(tiles, ExactCutCount(p, at, cut_mm).tiles())
          << "seed " << kSeed << " polygon " << polygon << " placement " << k << " cut " << cut_mm;
      more_than_whole += tiles.size() > tiles_inside(p, at, 0.0).size() ? 1 : 0;
    }
  }
  EXPECT_GT(more_than_whole, 120);  // In these cases the cut decides.
}

PlacementResult best(const Polygon& p, double cut_mm, bool proof = false) {
  PlacementOptions options;
  options.corner_cut_mm = cut_mm;
  options.keep_proof = proof;
  options.largest_clearance = false;
  return place(p, options);
}

// Makes the outline of one module with its corners cut off.
Polygon hexagon_outline(double cut_mm) {
  const std::array<Vec3, 3> corner{Vec3(0, 0, 0), Vec3(30, 0, 0), Vec3(15, kHeight_mm, 0)};
  Polygon p;
  const design::Outline outline = design::outline_of(corner, cut_mm);
  for (const Vec3& v : outline.points()) p.outer.emplace_back(v.x(), v.y());
  return test::moved(p, 0.7, {11, -5});
}

TEST(CornerCut, an_outline_that_is_one_module_holds_one_with_this_cut_and_none_with_less) {
  EXPECT_EQ(best(hexagon_outline(3.0), 3.0).modules, 1);
  EXPECT_EQ(best(hexagon_outline(3.0), 3.0).upper_bound, 1);
  EXPECT_EQ(best(hexagon_outline(3.0), 2.99).modules, 0);
  EXPECT_EQ(best(hexagon_outline(3.0), 0.0).upper_bound, 0);
  EXPECT_EQ(best(hexagon_outline(3.0), 5.0).modules, 1);
}

// The strip is as high as the rest of a cut module that stands on its tip: 25.98 mm less the height of one corner.
TEST(CornerCut, a_strip_lower_than_a_module_holds_modules_when_corners_are_cut) {
  const auto strip = [](double height) {
    Polygon p;
    p.outer = {{0, 0}, {300, 0}, {300, height}, {0, height}};
    return test::moved(p, 0.4, {0, 0});
  };
  const double height = kHeight_mm - design::cut_height_mm(3.0);
  EXPECT_EQ(best(strip(kHeight_mm - 0.01), 0.0).upper_bound, 0);
  // Only up modules fit, because the tips of down ones are lower.
  EXPECT_GE(best(strip(height + 0.01), 3.0).modules, 5);
  EXPECT_EQ(best(strip(height - 0.01), 3.0).upper_bound, 0);
}

TEST(CornerCut, certified_value_grows_with_the_cut_and_no_scan_finds_more) {
  std::mt19937_64 random(7);
  for (int k = 0; k < 6; ++k) {
    const Polygon p = test::random_polygon(random, 10 + 5 * k, 60.0 + 40.0 * k, k % 3);
    int before = 0;
    for (const double cut_mm : {0.0, 1.0, 3.0, 6.0}) {
      const PlacementResult r = best(p, cut_mm);
      ASSERT_TRUE(r.proved);
      EXPECT_GE(r.modules, before);
      before = r.modules;
      EXPECT_LE(test::most_by_scan(p, cut_mm, 7), r.upper_bound) << "polygon " << k << " cut " << cut_mm;
    }
  }
}

TEST(CornerCut, without_a_cut_nothing_changes) {
  std::mt19937_64 random(9);
  const Polygon p = test::random_polygon(random, 30, 200, 1);
  const PlacementResult r = best(p, 0.0, true);
  EXPECT_EQ(proof_text(p, r).find("corner_cut_mm"), std::string::npos);
  EXPECT_NE(proof_text(p, best(p, 3.0, true)).find("\"corner_cut_mm\":3.0"), std::string::npos);
}

std::string geojson(const Polygon& p) {
  nlohmann::json rings = nlohmann::json::array();
  const auto add = [&](const std::vector<Vec2>& ring) {
    nlohmann::json points = nlohmann::json::array();
    for (const Vec2& v : ring) points.push_back({v.x(), v.y()});
    points.push_back(points[0]);
    rings.push_back(points);
  };
  add(p.outer);
  for (const auto& hole : p.holes) add(hole);
  return nlohmann::json{{"type", "Polygon"}, {"coordinates", rings}}.dump();
}

TEST(CornerCut, proofs_are_accepted_and_those_of_another_cut_are_not) {
  std::mt19937_64 random(11);
  const Polygon p = test::random_polygon(random, 24, 150, 1);
  for (const double gap_mm : {0.0, 1.5}) {
    PlacementOptions options;
    options.corner_cut_mm = 3.0;
    options.gap_mm = gap_mm;
    options.keep_proof = true;
    options.largest_clearance = false;
    const PlacementResult r = place(p, options);
    nlohmann::json log = nlohmann::json::parse(proof_text(p, r));
    const auto report = [&] { return check::check_placement_proof_text(log.dump(), geojson(p)); };
    EXPECT_TRUE(report().accepted) << report().reason;
    log["corner_cut_mm"] = 0.0;  // Whole triangles do not lie inside.
    EXPECT_FALSE(report().accepted);
    EXPECT_NE(report().reason.find("does not lie inside"), std::string::npos) << report().reason;
    log["corner_cut_mm"] = 9.0;  // The cells do not show that no more fit.
    EXPECT_FALSE(report().accepted);
    log["corner_cut_mm"] = 10.5;
    EXPECT_EQ(report().reason, "corner_cut_mm is out of range");
    log["corner_cut_mm"] = 3.0;
    log["shape"] = "square";
    EXPECT_EQ(report().reason, "corner_cut_mm is out of range");
  }
}

TEST(CornerCut, connected_modules_share_long_sides) {
  std::mt19937_64 random(13);
  PlacementOptions options;
  options.corner_cut_mm = 3.0;
  options.connected = true;
  const PlacementResult r = place(test::random_polygon(random, 30, 200, 0), options);
  ASSERT_GT(r.modules, 10);
  for (const Tile& t : r.tiles) {
    int joined = 0;
    for (int s = 0; s < 3; ++s) joined += std::ranges::count(r.tiles, across(t, s).tile) > 0 ? 1 : 0;
    EXPECT_GT(joined, 0);
  }
}

TEST(CornerCut, bad_wishes_are_errors) {
  const auto refused = [](double cut_mm, TileShape shape, PlacementMethod method) {
    PlacementOptions options;
    options.corner_cut_mm = cut_mm;
    options.shape = shape;
    options.method = method;
    EXPECT_THROW((void)place(hexagon_outline(3.0), options), InputError);
  };
  refused(-0.1, TileShape::kTriangle, PlacementMethod::kBranchAndBound);
  refused(7.0, TileShape::kTriangle, PlacementMethod::kBranchAndBound);
  refused(std::nan(""), TileShape::kTriangle, PlacementMethod::kBranchAndBound);
  refused(3.0, TileShape::kSquare, PlacementMethod::kBranchAndBound);
  refused(3.0, TileShape::kTriangle, PlacementMethod::kR4);
}

}  // namespace
}  // namespace triskin::placement

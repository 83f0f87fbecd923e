// SPDX-License-Identifier: GPL-3.0-or-later
// Tests modules with cut corners on surfaces: overlap against exact arithmetic, border by hand, and layouts that only
// cut corners make possible.
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/convex_hull_2.h>
#include <gtest/gtest.h>

#include <random>

#include "shapes.hpp"
#include "triskin/base/error.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/lattice/map_modules.hpp"

namespace triskin::lattice {
namespace {

using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
using Point = Exact::Point_2;

std::array<Vec3, 3> module_at(double x, double y, double angle) {
  std::array<Vec3, 3> corner;
  for (int k = 0; k < 3; ++k) {
    const double a = angle + 2.0 * M_PI * k / 3.0;
    corner[at(k)] = {x + 2.0 * kHeight_mm / 3.0 * std::cos(a), y + 2.0 * kHeight_mm / 3.0 * std::sin(a), 0.0};
  }
  return corner;
}

std::vector<Point> exact_outline(const std::array<Vec3, 3>& corner, double cut_mm) {
  std::vector<Point> points;
  for (std::size_t k = 0; k < 3; ++k) {
    const Point a(corner[k].x(), corner[k].y()), b(corner[(k + 1) % 3].x(), corner[(k + 1) % 3].y());
    const Exact::FT part = Exact::FT(cut_mm) / 30;
    points.push_back(a + part * (b - a));
    points.push_back(b + part * (a - b));
  }
  return points;
}

// Returns the shortest way that separates two outlines: from the origin to the border of the set of all differences of
// their points.
double exact_depth(const std::vector<Point>& a, const std::vector<Point>& b) {
  std::vector<Point> differences, hull;
  for (const Point& p : a) {
    for (const Point& q : b) differences.push_back(CGAL::ORIGIN + (p - q));
  }
  CGAL::convex_hull_2(differences.begin(), differences.end(), std::back_inserter(hull));
  double least = 1e300;
  for (std::size_t k = 0; k < hull.size(); ++k) {
    const Point &from = hull[k], &to = hull[(k + 1) % hull.size()], origin(0, 0);
    if (CGAL::orientation(from, to, origin) != CGAL::LEFT_TURN) return 0.0;
    least = std::min(least, std::sqrt(CGAL::to_double(CGAL::squared_distance(Exact::Line_2(from, to), origin))));
  }
  return least;
}

TEST(CutModules, depth_of_overlap_equals_exact_arithmetic_on_600_pairs) {
  constexpr std::uint64_t kSeed = 20130302;
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> place(-30.0, 30.0), turn(0.0, 7.0);
  int overlapping = 0, parted_by_the_cut = 0;
  for (int k = 0; k < 600; ++k) {
    const double cut_mm = std::array{0.5, 3.0, 6.9}[at(k % 3)];
    const auto a = module_at(0, 0, turn(random)), b = module_at(place(random), place(random), turn(random));
    const double exact = exact_depth(exact_outline(a, cut_mm), exact_outline(b, cut_mm));
    ASSERT_NEAR(penetration_depth(a, b, cut_mm), exact, 1e-9) << "seed " << kSeed << " pair " << k;
    overlapping += exact > 0.0 ? 1 : 0;
    parted_by_the_cut += exact == 0.0 && penetration_depth(a, b) > 0.0 ? 1 : 0;
  }
  EXPECT_GT(overlapping, 100);
  EXPECT_GT(parted_by_the_cut, 10);
}

TEST(CutModules, inset_outlines_are_drawn_in_by_the_inset_on_every_side) {
  const auto corner = module_at(3, -4, 0.3);
  const Vec3 center(3, -4, 0);
  for (const double inset_mm : {0.1, 0.5, 2.0, 4.0}) {
    const design::Outline o = design::inset_outline(corner, 3.0, inset_mm);
    // A cut of 3 mm is 2.6 mm high; deeper in the corner only a point remains.
    ASSERT_EQ(o.size, inset_mm < 2.5 ? 6U : 3U);
    for (std::size_t k = 0; k < o.size; ++k) {
      const Vec3 a = o.point[k], along = (o.point[(k + 1) % o.size] - a).normalized();
      const double distance = (center - a - along.dot(center - a) * along).norm();
      const bool is_short = o.size == 6 && k % 2 == 1;
      EXPECT_NEAR(distance, (is_short ? design::short_side_offset_mm(3.0) : kHeight_mm / 3.0) - inset_mm, 1e-9);
    }
  }
}

// The tip of the module points over the straight border of a plate, which lies at x = 100.
PlacedModule pointing_over(double past_mm) {
  PlacedModule m;
  m.corner_mm = module_at(100.0 + past_mm - 2.0 * kHeight_mm / 3.0, 50.0, 0.0);
  return m;
}

TEST(CutModules, a_tip_over_the_border_counts_only_where_it_is_left) {
  const mesh::Surface surface(plane(100.0, 100.0));
  const double height = design::cut_height_mm(3.0);
  for (const double past_mm : {0.5, 2.5, 3.0, 4.5}) {
    PlacedModule whole = pointing_over(past_mm), cut = whole;
    measure_on_surface(surface, whole);
    measure_on_surface(surface, cut, 3.0);
    EXPECT_NEAR(whole.overrun_mm, past_mm, 0.03);
    EXPECT_NEAR(cut.overrun_mm, std::max(0.0, past_mm - height), 0.03);
    EXPECT_EQ(cut.center_gap_mm, whole.center_gap_mm);
  }
}

// A module on a ridge dips least below the surface at its corners, and most without them.
TEST(CutModules, depth_is_that_of_the_sides_that_are_left) {
  const mesh::Surface surface(half_cylinder(60.0, 100.0));
  PlacedModule m;
  m.corner_mm = {Vec3(-15, 40, 58), Vec3(15, 40, 58), Vec3(0, 40 + kHeight_mm, 58)};
  PlacedModule cut = m;
  measure_on_surface(surface, m);
  measure_on_surface(surface, cut, 3.0);
  EXPECT_NEAR(m.edge_depth_mm, cut.edge_depth_mm, 0.1);  // No side ends at the ridge.
  m.corner_mm = {Vec3(-15, 40, 50), Vec3(15, 40, 50), Vec3(0, 40 + kHeight_mm, 62)};
  cut = m;
  measure_on_surface(surface, m);
  measure_on_surface(surface, cut, 3.0);
  EXPECT_GT(m.edge_depth_mm, 0.0);
  EXPECT_LE(cut.edge_depth_mm, m.edge_depth_mm + 1e-9);
}

// On a height of 24 mm no whole module (25.98 mm) keeps 0.5 mm of overrun, but one whose tip is cut (23.38 mm) does.
TEST(CutModules, grow_on_a_strip_that_holds_no_whole_module) {
  const mesh::Surface strip(plane(200.0, 24.0));
  SurfaceLatticeOptions o = effort(60);
  EXPECT_TRUE(grow_lattice(strip, {}, o).modules.empty());
  o.corner_cut_mm = 3.0;
  ModuleLayout layout = grow_lattice(strip, {}, o);
  EXPECT_EQ(layout.corner_cut_mm, 3.0);
  EXPECT_GE(layout.modules.size(), 4U);
  for (const PlacedModule& m : layout.modules) EXPECT_LE(m.overrun_mm, 0.5);
  for (std::size_t a = 0; a < layout.modules.size(); ++a) {
    for (std::size_t b = a + 1; b < layout.modules.size(); ++b) {
      EXPECT_LE(
          exact_depth(exact_outline(layout.modules[a].corner_mm, 3.0), exact_outline(layout.modules[b].corner_mm, 3.0)),
          0.5);
    }
  }
}

TEST(CutModules, a_cut_out_of_range_is_an_error) {
  SurfaceLatticeOptions o = effort(1);
  for (const double cut_mm : {-1.0, 7.0, std::nan("")}) {
    o.corner_cut_mm = cut_mm;
    EXPECT_THROW((void)grow_lattice(mesh::Surface(plane(100.0, 100.0)), {}, o), InputError);
  }
}

}  // namespace
}  // namespace triskin::lattice

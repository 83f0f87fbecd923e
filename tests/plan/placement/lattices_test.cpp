// SPDX-License-Identifier: GPL-3.0-or-later
// Several lattices on one outline (docs/placement.md): hand-worked bounds, and brute force on tiny outlines.
#include "triskin/placement/lattices.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "triskin/placement/placement.hpp"
#include "triskin/placement/polygon_io.hpp"

namespace triskin::placement {
namespace {

Vec2 polar(double radius, double angle) {
  return {radius * std::cos(angle), radius * std::sin(angle)};
}
Polygon polygon(std::vector<Vec2> outer) {
  return normalize_polygon({std::move(outer), {}}, "outline");
}
Polygon rectangle(double width, double height) {
  return polygon({{0, 0}, {width, 0}, {width, height}, {0, height}});
}
LatticesOptions counted_steps(int steps, std::uint64_t seed = 1) {
  LatticesOptions options;
  options.steps = steps;
  options.seed = seed;
  return options;
}

FlatLayout placed(const Polygon& outline, const LatticesOptions& options) {
  const PlacementResult one = place(outline);
  return place_lattices(outline, {one.placement, one.tiles}, options);
}

TEST(ModulesBound, is_the_area_where_every_point_can_be_reached) {
  EXPECT_EQ(modules_bound(polygon({{0, 0}, {60, 0}, {30, 60 * std::sqrt(0.75)}}), 0.0, 1e-6), 4);  // Four modules.
  EXPECT_EQ(modules_bound(rectangle(100, 100), 0.0, 1e-6), 25);  // 10,000 / 389.711 = 25.66
}

TEST(ModulesBound, counts_parts_behind_a_neck_by_themselves) {
  // Two triangles of side 36, 1.44 modules each, and a neck 4 mm wide: 2.88 modules and the neck, but one each.
  const double h = 36 * std::sqrt(0.75);
  EXPECT_EQ(
      modules_bound(
          polygon({{0, 0}, {36, 0}, {36, 0.5}, {96, 0.5}, {96, 0}, {132, 0}, {114, h}, {97, 4.5}, {35, 4.5}, {18, h}}),
          0.0, 1e-6),
      2);
}

TEST(ModulesBound, leaves_out_what_no_module_reaches) {
  EXPECT_EQ(modules_bound(rectangle(600, 15), 0.0, 1e-6), 0);  // A strip narrower than an incircle, 17.3 mm.
  // A needle of 10°: 9.6 modules by area. The disc of 8.66 mm fits from 99.4 mm behind the tip on, reaching 17.3 mm.
  const double length = 300, half = length * std::tan(5.0 * std::numbers::pi / 180.0);
  const Polygon needle = polygon({{0, 0}, {length, -half}, {length, half}});
  const double reached = (1.0 - std::pow((8.66 / std::sin(5.0 * std::numbers::pi / 180.0) - 17.32) / length, 2.0)) *
                         length * half / kModuleArea_mm2;
  const int bound = modules_bound(needle, 0.0, 1e-6);
  EXPECT_LT(bound, static_cast<int>(length * half / kModuleArea_mm2));
  EXPECT_GE(bound, static_cast<int>(reached));
}

TEST(ModulesBound, a_gap_makes_modules_wider) {
  // 100 × 100 widened by 5 mm: 12,078.5 mm²; a module widened by 5 mm: 918.2 mm².
  EXPECT_EQ(modules_bound(rectangle(100, 100), 10.0, 1e-6), 13);
}

TEST(Lattices, two_parts_turned_against_each_other_need_two) {
  // Triangles of side 31 at the ends of a neck, one of them turned by 25°: one lattice holds one module.
  std::vector<Vec2> outer;
  const auto corner = [](const Vec2& middle, double turn, int k) {
    return Vec2(middle + polar(31 / std::sqrt(3.0), turn + 2.0 * std::numbers::pi / 3.0 * k));
  };
  const Vec2 left(0, 0), right(70, 0);
  const double turn = 25.0 * std::numbers::pi / 180.0;
  // The tip of the left one points to the right; the neck joins it to the far corner of the other.
  const Polygon outline = polygon({corner(left, 0, 1), corner(left, 0, 2), corner(left, 0, 0) + Vec2(-1, -0.577),
                                   corner(right, turn, 1) + Vec2(0, -1), corner(right, turn, 2), corner(right, turn, 0),
                                   corner(right, turn, 1), corner(left, 0, 0) + Vec2(-1, 0.577)});
  const FlatLayout layout = placed(outline, counted_steps(2000));
  const PlacementResult one = place(outline);
  EXPECT_TRUE(one.proved);
  EXPECT_EQ(one.modules, 1);
  EXPECT_EQ(layout.modules, 2);
  EXPECT_EQ(layout.upper_bound, 2);
  EXPECT_EQ(layout.lattices.size(), 2U);
}

TEST(Lattices, one_lattice_is_the_placed_one) {
  const Polygon outline = rectangle(97, 83);
  LatticesOptions options = counted_steps(100);
  options.max_lattices = 1;
  const FlatLayout layout = placed(outline, options);
  EXPECT_EQ(layout.lattices.size(), 1U);
  EXPECT_EQ(layout.modules, place(outline).modules);
}

TEST(Lattices, equal_steps_and_seed_give_equal_layouts_and_more_steps_no_fewer_modules) {
  const Polygon outline = rectangle(113, 71);
  const LatticesOptions options = counted_steps(300);
  EXPECT_EQ(flat_layout_text(outline, placed(outline, options), options),
            flat_layout_text(outline, placed(outline, options), options));
  EXPECT_GE(placed(outline, counted_steps(900)).modules, placed(outline, options).modules);
}

TEST(Lattices, are_the_same_100_km_from_the_origin) {
  const std::vector<Vec2> l{{0, 0}, {140, 0}, {140, 60}, {65, 60}, {65, 140}, {0, 140}};
  std::vector<Vec2> far = l;
  for (Vec2& p : far) p += Vec2(1e8 - 140, 140 - 1e8);
  const FlatLayout here = placed(polygon(l), counted_steps(300)), there = placed(polygon(far), counted_steps(300));
  EXPECT_EQ(here.modules, there.modules);
  EXPECT_EQ(here.upper_bound, there.upper_bound);
  ASSERT_EQ(here.lattices.size(), there.lattices.size());
  for (std::size_t k = 0; k < here.lattices.size(); ++k)
    EXPECT_EQ(here.lattices[k].tiles.size(), there.lattices[k].tiles.size());
}

// Pieces of a net have vertices in the middle of a side, and cracks whose two sides are one line.
TEST(Lattices, take_vertices_on_a_side_and_cracks) {
  std::vector<Vec2> outer;
  for (int k = 0; k < 10; ++k) outer.emplace_back(11.0 * k, 0.0);
  outer.insert(outer.end(), {{110, 0}, {110, 70}, {55, 70}, {55, 30}, {55, 70}, {0, 70}});
  const FlatLayout layout = placed(polygon(outer), counted_steps(300));
  EXPECT_GE(layout.modules, place(polygon(outer)).modules);
  EXPECT_LE(layout.modules, layout.upper_bound);
}

// Brute force: all sets of modules among the places of a fine raster, turned along every edge and by steps of 10°.
class BruteForce {
 public:
  explicit BruteForce(const Polygon& outline) : outline_(outline) {
    std::vector<double> angles;
    for (int k = 0; k < 12; ++k) angles.push_back(k * std::numbers::pi / 18.0);
    for (std::size_t k = 0; k < outline.outer.size(); ++k) {
      const Vec2 d = outline.outer[(k + 1) % outline.outer.size()] - outline.outer[k];
      angles.push_back(std::atan2(d.y(), d.x()));
    }
    Vec2 low = outline.outer[0], high = low;
    for (const Vec2& p : outline.outer) low = low.cwiseMin(p), high = high.cwiseMax(p);
    constexpr double kStep_mm = 3.0;
    for (const double angle : angles) {
      for (double x = low.x(); x <= high.x(); x += kStep_mm) {
        for (double y = low.y(); y <= high.y(); y += kStep_mm) add(Vec2(x, y), angle);
      }
      // Into every corner of the outline.
      for (const Vec2& p : outline.outer) {
        for (int k = 0; k < 3; ++k)
          add(p - polar(kRadius, angle - std::numbers::pi / 6.0 + k * 2.0 * std::numbers::pi / 3.0), angle);
      }
    }
  }

  int most() {
    std::vector<std::size_t> all(places_.size());
    for (std::size_t k = 0; k < all.size(); ++k) all[k] = k;
    grow(all, 0);
    return most_;
  }

 private:
  using Corners = std::array<Vec2, 3>;
  static constexpr double kRadius = 17.320508075688775;

  void add(const Vec2& middle, double angle) {
    Corners corner;
    for (std::size_t k = 0; k < 3; ++k)
      corner[k] = middle + polar(kRadius, angle - std::numbers::pi / 6.0 +
                                              static_cast<double>(k) * 2.0 * std::numbers::pi / 3.0);
    if (is_inside(corner)) places_.push_back(corner);
  }
  // The outlines are convex: a module is inside if its corners are.
  [[nodiscard]] bool is_inside(const Corners& corner) const {
    for (std::size_t k = 0; k < outline_.outer.size(); ++k) {
      const Vec2 &a = outline_.outer[k], d = outline_.outer[(k + 1) % outline_.outer.size()] - a;
      for (const Vec2& p : corner) {
        if (d.x() * (p - a).y() - d.y() * (p - a).x() < -1e-9 * d.norm()) return false;
      }
    }
    return true;
  }
  static bool apart(const Corners& a, const Corners& b) {
    for (const auto* t : {&a, &b}) {
      const Corners& other = t == &a ? b : a;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 side = (*t)[(k + 1) % 3] - (*t)[k];
        bool beyond = true;
        for (const Vec2& p : other)
          beyond = beyond && side.x() * (p - (*t)[k]).y() - side.y() * (p - (*t)[k]).x() <= 1e-9 * 30;
        if (beyond) return true;
      }
    }
    return false;
  }
  void grow(const std::vector<std::size_t>& free, int chosen) {
    most_ = std::max(most_, chosen);
    if (chosen == 4) return;
    for (std::size_t k = 0; k < free.size(); ++k) {
      std::vector<std::size_t> rest;
      for (std::size_t n = k + 1; n < free.size(); ++n) {
        if (apart(places_[free[k]], places_[free[n]])) rest.push_back(free[n]);
      }
      if (chosen + 1 > most_) most_ = chosen + 1;
      if (most_ < 4 && !rest.empty()) grow(rest, chosen + 1);
      if (most_ == 4) return;
    }
  }

  const Polygon& outline_;
  std::vector<Corners> places_;
  int most_ = 0;
};

TEST(Lattices, are_no_worse_than_brute_force_on_tiny_outlines) {
  constexpr std::uint64_t kSeed = 5757;
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> radius(24.0, 34.0), turn(-0.3, 0.3);
  int several_win = 0;
  for (int k = 0; k < 20; ++k) {
    const int corners = 3 + k % 4;
    const double r = radius(random);
    std::vector<Vec2> outer;  // On a circle, so convex.
    for (int c = 0; c < corners; ++c) outer.push_back(polar(r, (c + turn(random)) * 2.0 * std::numbers::pi / corners));
    const Polygon outline = polygon(outer);
    const int bound = modules_bound(outline, 0.0, 1e-6);
    ASSERT_LE(bound, 7);
    const int brute = BruteForce(outline).most();
    const FlatLayout layout = placed(outline, counted_steps(1500));
    EXPECT_GE(layout.modules, brute) << "seed " << kSeed << " outline " << k;
    EXPECT_LE(layout.modules, bound) << "seed " << kSeed << " outline " << k;
    several_win += layout.modules > place(outline).modules ? 1 : 0;
  }
  EXPECT_GT(several_win, 0);
}

}  // namespace
}  // namespace triskin::placement

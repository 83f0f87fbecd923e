// SPDX-License-Identifier: GPL-3.0-or-later
// The overlap of two modules at all angles (docs/limits.md, penetration_mm): solver and checker, which share no code,
// against whole numbers without rounding.
#include <CGAL/Exact_integer.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "body_overlap.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/lattice/map_modules.hpp"

namespace triskin::check {
namespace {

using Whole = CGAL::Exact_integer;
using Whole3 = std::array<Whole, 3>;
using Corners = std::array<design::Vec3, 3>;
using design::Vec3;

constexpr double kGrid = 0x1p40;  // Points are multiples of 2⁻⁴⁰ mm, which doubles of this size hold exactly.

Vec3 on_grid(const Vec3& p) {
  return (p * kGrid).array().round() / kGrid;
}
Whole3 whole(const Vec3& p) {
  return {Whole(std::round(p.x() * kGrid)), Whole(std::round(p.y() * kGrid)), Whole(std::round(p.z() * kGrid))};
}
Whole dot(const Whole3& a, const Whole3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Whole3 cross(const Whole3& a, const Whole3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Whole3 minus(const Whole3& a, const Whole3& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

// Least overlap over the axes, in mm; each comparison is exact, and only the answer is rounded.
double least_overlap(const std::vector<Whole3>& a, const std::vector<Whole3>& b, const std::vector<Whole3>& axes) {
  double least = 1e300;
  for (const Whole3& axis : axes) {
    const Whole square = dot(axis, axis);
    if (square == 0) continue;
    const auto range = [&](const std::vector<Whole3>& points) {
      std::array<Whole, 2> r{dot(axis, points[0]), dot(axis, points[0])};
      for (const Whole3& p : points) {
        const Whole at = dot(axis, p);
        if (at < r[0]) r[0] = at;
        if (r[1] < at) r[1] = at;
      }
      return r;
    };
    const auto of_a = range(a), of_b = range(b);
    const Whole one = of_a[1] - of_b[0], other = of_b[1] - of_a[0], overlap = one < other ? one : other;
    if (overlap <= 0) return 0.0;
    least = std::min(least, CGAL::to_double(overlap) / std::sqrt(CGAL::to_double(square)) / kGrid);
  }
  return least;
}

std::vector<Vec3> outline(const Corners& corner, double cut_mm) {
  const design::Outline o = design::outline_of(corner, cut_mm);
  return {o.point.begin(), o.point.begin() + static_cast<std::ptrdiff_t>(o.size)};
}
Vec3 normal(const Corners& c) {
  return (c[1] - c[0]).cross(c[2] - c[0]).normalized();
}

double exact_overlap(const Corners& a, const Corners& b, double cut_mm) {
  const Vec3 na = normal(a), nb = normal(b);
  const bool as_bodies = na.dot(nb) < -0.2;
  const Vec3 mean = na + nb, between = (b[0] + b[1] + b[2] - a[0] - a[1] - a[2]) / 3.0;
  if (!as_bodies && std::abs(mean.dot(between)) > 10.0 * mean.norm()) return 0.0;
  std::array<std::vector<Whole3>, 2> points, edges;
  std::vector<Whole3> axes;
  for (std::size_t of = 0; of < 2; ++of) {
    const std::vector<Vec3> flat = outline(of == 0 ? a : b, cut_mm);
    const Vec3 n = of == 0 ? na : nb;
    for (std::size_t k = 0; k < flat.size(); ++k) {
      points[of].push_back(whole(flat[k]));
      edges[of].push_back(minus(whole(flat[(k + 1) % flat.size()]), whole(flat[k])));
      axes.push_back(cross(edges[of].back(), whole(as_bodies ? n : mean)));
    }
    if (!as_bodies) continue;
    for (const Vec3& p : flat) points[of].push_back(whole(p + 2.0 * n));
    edges[of].push_back(whole(n));
    axes.push_back(whole(n));
  }
  for (const Whole3& e : edges[0]) {
    for (const Whole3& f : edges[1]) {
      if (as_bodies) axes.push_back(cross(e, f));
    }
  }
  return least_overlap(points[0], points[1], axes);
}

Corners module_at(const Vec3& center, const Eigen::Quaterniond& turn) {
  Corners corner;
  for (std::size_t k = 0; k < 3; ++k) {
    const double angle = 2.0943951023931953 * static_cast<double>(k);
    corner[k] =
        on_grid(center + turn * Vec3(std::cos(angle), std::sin(angle), 0.0) * design::kSide_mm / std::sqrt(3.0));
  }
  return corner;
}

TEST(OverlapAtAllAngles, solver_and_checker_equal_exact_arithmetic_on_10000_pairs) {
  constexpr std::uint64_t kSeed = 20570057;
  std::mt19937_64 random(kSeed);
  std::normal_distribution<double> gauss;
  std::uniform_real_distribution<double> place(-14.0, 14.0), angle(0.0, std::numbers::pi);
  const auto turn = [&] {
    return Eigen::Quaterniond(gauss(random), gauss(random), gauss(random), gauss(random)).normalized();
  };
  std::array<int, 9> overlapping{}, apart{};  // By 20° between the normals.
  for (int k = 0; k < 10'000; ++k) {
    const double cut_mm = std::array{0.0, 0.0, 3.0, 6.9}[static_cast<std::size_t>(k % 4)];
    const Eigen::Quaterniond of_a = turn();
    const double between = angle(random), direction = 2.0 * angle(random);
    const Vec3 hinge(std::cos(direction), std::sin(direction), 0.0);
    const Eigen::Quaterniond of_b = of_a * Eigen::Quaterniond(Eigen::AngleAxisd(between, hinge)) *
                                    Eigen::Quaterniond(Eigen::AngleAxisd(2.0 * angle(random), Vec3::UnitZ()));
    const Corners a = module_at(Vec3(5.0, -7.0, 3.0), of_a);
    const Corners b = module_at(Vec3(5.0, -7.0, 3.0) + Vec3(place(random), place(random), 0.5 * place(random)), of_b);
    const double exact = exact_overlap(a, b, cut_mm);
    ASSERT_NEAR(lattice::penetration_depth(a, b, cut_mm), exact, 1e-9) << "solver, seed " << kSeed << " pair " << k;
    ASSERT_NEAR(module_overlap(a, b, cut_mm), exact, 1e-9) << "checker, seed " << kSeed << " pair " << k;
    auto& count = exact > 0.0 ? overlapping : apart;
    ++count[static_cast<std::size_t>(std::min(8.0, between / std::numbers::pi * 9.0))];
  }
  for (std::size_t bin = 0; bin < 9; ++bin) {
    EXPECT_GT(overlapping[bin], 50) << "of " << 20 * bin << "° and more";
    EXPECT_GT(apart[bin], 50) << "of " << 20 * bin << "° and more";
  }
}

// Worked by hand: bodies 2 mm high.
TEST(OverlapAtAllAngles, facing_modules_overlap_by_what_their_heights_miss) {
  const Eigen::Quaterniond up = Eigen::Quaterniond::Identity(), down(0.0, 1.0, 0.0, 0.0);
  const Corners a = module_at(Vec3::Zero(), up);
  const auto both = [&](const Corners& b, double expected) {
    EXPECT_NEAR(lattice::penetration_depth(a, b), expected, 1e-9);
    EXPECT_NEAR(module_overlap(a, b, 0.0), expected, 1e-9);
  };
  both(module_at(Vec3(0, 0, 5.0), down), 0.0);    // 1 mm of air between the two layers
  both(module_at(Vec3(0, 0, 3.5), down), 0.5);    // 2 + 2 − 3.5
  both(module_at(Vec3(0, 0, -0.5), down), 0.0);   // back to back across a wall of 0.5 mm
  both(module_at(Vec3(0, 0, 0.75), down), 0.75);  // 0.75 mm inside the wall: that far back
}

}  // namespace
}  // namespace triskin::check

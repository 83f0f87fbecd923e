// SPDX-License-Identifier: GPL-3.0-or-later
// Compares layouts on surfaces of known curvature with closed formulas; copies of one surface must give the same count.
#include "shapes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

namespace triskin::lattice {
namespace {

constexpr double kHeight = 25.980762113533160;

double mean_fold(const ModuleLayout& layout) {
  double sum = 0.0;
  int joints = 0;
  for (const PlacedModule& m : layout.modules) {
    for (int s = 0; s < 3; ++s) {
      if (m.neighbour[at(s)] < 0) continue;
      sum += m.fold_rad[at(s)];
      ++joints;
    }
  }
  return joints > 0 ? sum / joints : 0.0;
}

void expect_limits(const ModuleLayout& layout, const LayoutLimits& l = {}) {
  for (const PlacedModule& m : layout.modules) {
    EXPECT_LE(m.edge_error_mm, l.edge_error_mm);
    EXPECT_LE(m.center_gap_mm, l.center_gap_mm);
    EXPECT_LE(m.penetration_mm, l.penetration_mm);
    EXPECT_LE(m.overrun_mm, l.overrun_mm);
    EXPECT_LE(*std::ranges::max_element(m.hinge_gap_mm), l.hinge_gap_mm);
    EXPECT_LE(*std::ranges::max_element(m.fold_rad), l.fold_rad);
  }
}

class SphereFormula : public testing::TestWithParam<double> {};
TEST_P(SphereFormula, FoldAndCentreGapFollowTheRadius) {
  const double radius = GetParam();
  const mesh::Surface surface(turned_outward(sphere_cap(radius, 1.3), Vec3::Zero()));
  SurfaceLatticeOptions o = effort(6);
  o.corner_lift_mm = 0.0;
  const ModuleLayout layout = grow_lattice(surface, {}, o);
  ASSERT_GE(layout.modules.size(), 6U);
  expect_limits(layout);
  // The corners lie on the sphere: the plane of three of them is sqrt(R² − (2h/3)²) from its middle, and the facets
  // of the mesh a little less than R.
  const double gap = radius - std::sqrt(radius * radius - 4.0 / 9.0 * kHeight * kHeight);
  EXPECT_NEAR(gap, 30.0 * 30.0 * (2.0 / radius) / 12.0, 0.05 * gap);
  for (const PlacedModule& m : layout.modules) EXPECT_NEAR(m.center_gap_mm, gap, 0.5);
  EXPECT_NEAR(mean_fold(layout), kHeight * (2.0 / 3.0) / radius, 0.12 * kHeight / radius);
}
INSTANTIATE_TEST_SUITE_P(Radii, SphereFormula, testing::Values(75.0, 100.0, 150.0));

struct Shape {
  const char* name;
  Mesh mesh;
};
std::vector<Shape> shapes() {
  const auto cone = [](double u, double v) {
    const double slant = 60.0 + 120.0 * v, angle = 2.5 * u;
    return Vec3(slant * 0.8 * std::cos(angle), slant * 0.8 * std::sin(angle), -0.6 * slant);
  };
  const auto saddle = [](double u, double v) {
    const double x = 160.0 * (u - 0.5), y = 160.0 * (v - 0.5);
    return Vec3(x, y, (x * x - y * y) / 300.0);
  };
  const auto torus = [](double u, double v) {
    const double a = 1.6 * u, b = 2.8 * (v - 0.5), r = 130.0 + 60.0 * std::cos(b);
    return Vec3(r * std::cos(a), r * std::sin(a), 60.0 * std::sin(b));
  };
  return {
      {"cone", grid_mesh(30, 12, cone)}, {"saddle", grid_mesh(20, 20, saddle)}, {"torus", grid_mesh(24, 24, torus)}};
}

TEST(Shapes, EveryLimitHoldsAndMostIsCovered) {
  for (const Shape& shape : shapes()) {
    const mesh::Surface surface(shape.mesh);
    const ModuleLayout layout = grow_lattice(surface, {}, effort(15));
    SCOPED_TRACE(shape.name);
    expect_limits(layout);
    EXPECT_GE(static_cast<double>(layout.modules.size()) * kModuleArea_mm2, 0.6 * surface.area_mm2());
  }
}

// The corners are at the distance ρ from the centre, ρ² = a² / 3, 120° apart: whatever the turn, the mean height
// of a quadratic surface under them is ρ² (κ1 + κ2) / 4. The function returns the sum of the principal curvatures
// at a point of each shape, from its formula.
double curvature_of(const std::string& shape, const Vec3& p) {
  const double r = std::hypot(p.x(), p.y());
  if (shape == "cone") return 0.6 / r;  // A side (0.8, −0.6) has the normal (0.6, 0.8).
  if (shape == "torus") {
    const double cosine = std::cos(std::atan2(p.z(), r - 130.0));
    return 1.0 / 60.0 + cosine / (130.0 + 60.0 * cosine);
  }
  const double zx = p.x() / 150.0, zy = -p.y() / 150.0;
  return ((1.0 + zy * zy) - (1.0 + zx * zx)) / 150.0 / std::pow(1.0 + zx * zx + zy * zy, 1.5);
}

TEST(Shapes, CentreGapFollowsTheCurvatureAtEachModule) {
  for (const Shape& shape : shapes()) {
    const mesh::Surface surface(shape.mesh);
    SurfaceLatticeOptions o = effort(6);
    o.corner_lift_mm = 0.0;
    const ModuleLayout layout = grow_lattice(surface, {}, o);
    SCOPED_TRACE(shape.name);
    ASSERT_GE(layout.modules.size(), 10U);
    for (const PlacedModule& m : layout.modules) {
      const Vec3 foot = surface.closest(center_of(m)).position_mm;
      EXPECT_NEAR(m.center_gap_mm, 30.0 * 30.0 * std::abs(curvature_of(shape.name, foot)) / 12.0, 0.4);
    }
  }
}

// On a torus patch of about 500 cm², copies that are turned, mirrored or meshed anew must give the same within 3 %.
// The search weighs modules against islands and controllers: five seeds on each of the two meshes gave 117 … 124
// modules (`triskin design --iterations 150 --threads 1`), with a standard deviation of 2.6. Another mesh acts like
// another seed: two single results differ by 3 % in every third try, means of five seeds by 2.6 · √(2/5) = 1.6
// modules or 1.4 % (standard deviation).
Mesh large_patch(int nu, int nv) {
  return grid_mesh(nu, nv, [](double u, double v) {
    const double a = 1.5 * u, b = 2.4 * (v - 0.5), r = 140.0 + 80.0 * std::cos(b);
    return Vec3(r * std::cos(a), r * std::sin(a), 80.0 * std::sin(b));
  });
}

TEST(Shapes, CopiesGiveTheSameCountWithinThreePercent) {
  const Mesh original = large_patch(24, 20);
  Mesh turned = original, mirrored = original;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  for (Vec3& v : turned.vertices) v = turn * v + Vec3(500, -20, 7);
  for (Vec3& v : mirrored.vertices) v.x() = -v.x();
  for (auto& f : mirrored.faces) std::swap(f[1], f[2]);
  const auto count = [](const Mesh& m, std::uint64_t seed = 1) {
    SurfaceLatticeOptions o = effort(150);
    o.seed = seed;
    return static_cast<double>(grow_lattice(mesh::Surface(m), {}, o).modules.size());
  };
  const auto mean_count = [&](const Mesh& m) {
    constexpr std::uint64_t kSeeds = 5;
    double sum = 0.0;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) sum += count(m, seed);
    return sum / static_cast<double>(kSeeds);
  };
  const double expected = count(original);
  EXPECT_GE(expected, 80.0);
  EXPECT_NEAR(count(turned), expected, 0.03 * expected);
  EXPECT_NEAR(count(mirrored), expected, 0.03 * expected);
  const double mean = mean_count(original);
  EXPECT_NEAR(mean_count(large_patch(41, 37)), mean, 0.03 * mean);
}

}  // namespace
}  // namespace triskin::lattice

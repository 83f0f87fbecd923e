// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the largest overhang of a module over the border with a fine grid of points, and limits its cost where the
// border of other sheets runs along the surface, as in a skin with ribs or one that a repair left with cracks.
#include "plan/lattice/src/overrun.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <random>

#include "plan/mesh/broken_meshes.hpp"
#include "shapes.hpp"
#include "triskin/design/tile.hpp"

namespace triskin::lattice {
namespace {

constexpr double kCell_mm = 25.0;
constexpr int kCells = 8;

// Makes a skin of square cells, bent to a radius along x, with a crack between each two.
Mesh cracked_skin(double crack_mm, double radius_mm, bool with_hole) {
  Mesh skin;
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      if (with_hole && i == 4 && j == 4) continue;
      test::append(skin, grid_mesh(4, 1, [&](double u, double v) {
                     const double side = kCell_mm - crack_mm,
                                  x = (i - 0.5 * kCells) * kCell_mm + 0.5 * crack_mm + side * u;
                     const double angle = x / radius_mm;
                     return Vec3(radius_mm * std::sin(angle), (j - 0.5 * kCells) * kCell_mm + 0.5 * crack_mm + side * v,
                                 radius_mm * (std::cos(angle) - 1.0));
                   }));
    }
  }
  return skin;
}

// Makes walls under a flat skin that end at it, or `gap_mm` below; none shares a vertex with it.
Mesh ribs(double gap_mm) {
  Mesh walls;
  for (int k = 1; k < 3 * kCells; ++k) {
    const double at_mm = (k / 3.0 - 0.5 * kCells) * kCell_mm, half_mm = 0.45 * kCells * kCell_mm;
    test::append(walls, grid_mesh(1, 1, [&](double u, double v) {
                   return Vec3(at_mm, half_mm * (2.0 * u - 1.0), -gap_mm - 20.0 * v);
                 }));
  }
  return walls;
}

design::Outline module_at(const Vec3& center, double turn_rad, const Vec3& tilt_axis = Vec3::UnitX(),
                          double tilt_rad = 0.0) {
  std::array<Vec3, 3> corner{Vec3(-15, -kHeight_mm / 3, 0), Vec3(15, -kHeight_mm / 3, 0),
                             Vec3(0, 2 * kHeight_mm / 3, 0)};
  const Eigen::AngleAxisd turn(turn_rad, Vec3::UnitZ()), tilt(tilt_rad, tilt_axis.normalized());
  for (Vec3& c : corner) c = center + tilt * (turn * c);
  return design::outline_of(corner, 0.0);
}

// Returns the largest distance across the border over the points of a grid.
double over_a_grid(const mesh::Surface& surface, const design::Outline& module) {
  constexpr int kSteps = 150;
  const auto corner = module.points();
  double most = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; i + j <= kSteps; ++j) {
      const Vec3 p = corner[0] + (corner[1] - corner[0]) * i / kSteps + (corner[2] - corner[0]) * j / kSteps;
      const mesh::SurfacePoint border = surface.closest_on_border(p);
      if (border.distance_mm > surface.closest(p).distance_mm + 1e-9) continue;
      const Vec3 off = p - border.position_mm, n = surface.normal_at(border);
      most = std::max(most, (off - off.dot(n) * n).norm());
    }
  }
  return most;
}

// Following one line of border under a module in the smallest parts costs ten times as many.
constexpr std::size_t kManyPoints = 10'000;

TEST(Overrun, a_rib_under_the_skin_is_no_border_of_it_and_costs_little) {
  for (const double gap_mm : {0.0, 1e-3, 1e-2}) {
    Mesh mesh = plane(200.0, 200.0);
    for (Vec3& v : mesh.vertices) v -= Vec3(100.0, 100.0, 0.0);
    test::append(mesh, ribs(gap_mm));
    const mesh::Surface surface(mesh);
    for (const double height_mm : {0.0, 0.01, 0.5, 2.0}) {
      for (const double turn_rad : {0.0, 0.3, M_PI / 6}) {
        const Overrun o = overrun_of(surface, module_at({1.0, 2.0, height_mm}, turn_rad));
        EXPECT_LE(o.mm, height_mm + 0.02) << gap_mm << " " << height_mm << " " << turn_rad;
        EXPECT_LT(o.points, kManyPoints) << gap_mm << " " << height_mm << " " << turn_rad;
      }
    }
  }
}

TEST(Overrun, a_crack_in_the_skin_counts_by_its_width_and_costs_little) {
  for (const double crack_mm : {1e-4, 2e-3, 1e-2}) {
    for (const double radius_mm : {100.0, 1e5}) {
      const mesh::Surface surface(cracked_skin(crack_mm, radius_mm, false));
      for (const double turn_rad : {0.0, 0.3, M_PI / 6}) {
        const Overrun o = overrun_of(surface, module_at({1.0, 2.0, 0.3}, turn_rad));
        EXPECT_LE(o.mm, crack_mm + 0.05) << crack_mm << " " << radius_mm << " " << turn_rad;
        EXPECT_LT(o.points, kManyPoints) << crack_mm << " " << radius_mm << " " << turn_rad;
      }
    }
  }
}

TEST(Overrun, is_the_largest_of_a_fine_grid_beside_a_hole_a_rim_ribs_and_cracks) {
  constexpr int kSeed = 5, kModules = 30;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  int over = 0;
  for (const double crack_mm : {0.0, 1e-3, 0.2}) {
    for (const double radius_mm : {80.0, 1e5}) {
      Mesh mesh = cracked_skin(crack_mm, radius_mm, true);
      if (radius_mm > 1e4) test::append(mesh, ribs(1e-3));
      const mesh::Surface surface(mesh);
      for (int k = 0; k < kModules; ++k) {
        const double reach_mm = k % 2 == 0 ? 30.0 : 110.0;
        const double x = 12.5 + reach_mm * unit(random), angle = x / radius_mm;
        const Vec3 axis(unit(random), unit(random), unit(random));
        const Vec3 center(radius_mm * std::sin(angle), 12.5 + reach_mm * unit(random),
                          radius_mm * (std::cos(angle) - 1.0) + unit(random));
        const Eigen::AngleAxisd lie(angle, Vec3::UnitY());
        design::Outline module = module_at(Vec3::Zero(), 3.0 * unit(random), axis, 0.05 * unit(random));
        for (Vec3& p : module.point) p = center + lie * p;
        const double found_mm = overrun_of(surface, module).mm, grid_mm = over_a_grid(surface, module);
        EXPECT_GE(found_mm, grid_mm - 0.02 - 1e-9)
            << "seed " << kSeed << ", crack " << crack_mm << ", radius " << radius_mm << ", module " << k;
        EXPECT_LE(found_mm, grid_mm + 0.3) << "seed " << kSeed << ", crack " << crack_mm << ", module " << k;
        over += grid_mm > 0.5 ? 1 : 0;
      }
    }
  }
  EXPECT_GE(over, 60);  // With fewer, next to nothing was compared.
}

}  // namespace
}  // namespace triskin::lattice

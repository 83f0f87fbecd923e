// SPDX-License-Identifier: GPL-3.0-or-later
// A part may lie far from the origin of its file: coordinates of 1e8 mm are whole multiples of 1.5e-8 mm.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "overrun.hpp"
#include "rigid.hpp"
#include "shapes.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/lattice/grow_lattice.hpp"
#include "triskin/mesh/generate.hpp"

namespace triskin::lattice {
namespace {

Mesh shifted(Mesh m, const Vec3& shift_mm) {
  for (Vec3& v : m.vertices) v += shift_mm;
  return m;
}

constexpr unsigned kSeed = 4;

// Measures a module on a surface far away and on the same one at the origin. Both the mesh and the corners are rounded
// far away and moved back exactly, so only the computations differ.
void expect_same_measures(const Mesh& mesh, const std::vector<std::array<Vec3, 3>>& modules) {
  const Vec3 far_mm(1e8, -1e8, 1e8);
  const Mesh there = shifted(mesh, far_mm), here = shifted(there, -far_mm);
  const mesh::Surface far_surface(there), surface(here);
  for (std::size_t k = 0; k < modules.size(); ++k) {
    std::array<Vec3, 3> far_corners = modules[k], corners = modules[k];
    for (std::size_t c = 0; c < 3; ++c) corners[c] = (far_corners[c] += far_mm) - far_mm;
    const design::Outline outline = design::outline_of(corners, 0.0),
                          far_outline = design::outline_of(far_corners, 0.0);
    const SideHeights expected = walk_sides(surface, outline, 0.5), found = walk_sides(far_surface, far_outline, 0.5);
    constexpr double kRoundings_mm = 1e-6;  // Points of sides, feet and heights are rounded by up to 1.5e-8 each time.
    EXPECT_NEAR(found.lift_mm, expected.lift_mm, kRoundings_mm) << "module " << k;
    EXPECT_NEAR(found.depth_mm, expected.depth_mm, kRoundings_mm) << "module " << k;
    constexpr double kSearch_mm = 0.04;  // Each value is found to 0.02 mm.
    EXPECT_NEAR(overrun_of(far_surface, far_outline).mm, overrun_of(surface, outline).mm, kSearch_mm) << "module " << k;
  }
}

TEST(FarSurface, modules_on_a_dome_are_measured_as_at_the_origin) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> place(-100.0, 100.0), turn(-1.0, 1.0);
  std::vector<std::array<Vec3, 3>> modules;
  for (int k = 0; k < 100; ++k) {
    const Vec3 x = Vec3(turn(random), turn(random), 0.3 * turn(random)).normalized(),
               y = Vec3::UnitZ().cross(x).normalized(), c(place(random), place(random), 140.0);
    modules.push_back({c - 15.0 * x - 9.0 * y, c + 15.0 * x - 9.0 * y, c + 17.0 * y});
  }
  expect_same_measures(sphere_cap(150.0, 1.0), modules);
}

// Along a side across the ridge of a roof the foot stays at one point, which is computed anew from other weights: the
// next foot is then as far as the last one but for rounding, which a search within that distance must contain.
TEST(FarSurface, modules_across_a_ridge_are_measured_as_at_the_origin) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const Mesh roof = grid_mesh(2, 1, [&](double u, double v) {
    return Vec3(turn * Vec3(200.0 * u - 100.0, 300.0 * v - 150.0, -0.3 * std::abs(200.0 * u - 100.0)));
  });
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> along(-100.0, 100.0), height(0.0, 6.0), off(-5.0, 5.0);
  std::vector<std::array<Vec3, 3>> modules;
  for (int k = 0; k < 100; ++k) {
    const Vec3 a(off(random) - 15.0, along(random), height(random));
    modules.push_back({turn * a, turn * (a + Vec3(30, 0, 0)), turn * (a + Vec3(15, 26, 0))});
  }
  expect_same_measures(roof, modules);
}

TEST(FarSurface, has_the_layout_of_the_same_surface_at_the_origin) {
  const Mesh cover = mesh::generate(mesh::Shape::kHip, {.size_mm = 130.0, .faces = 400});
  const auto layout_at = [&](const Vec3& shift_mm) {
    return grow_lattice(mesh::Surface(shifted(cover, shift_mm)), {}, effort(60));
  };
  const ModuleLayout here = layout_at(Vec3::Zero());
  ASSERT_GT(here.modules.size(), 10U);
  for (const double away_mm : {1e5, 1e8}) {
    const ModuleLayout there = layout_at({away_mm, -away_mm, away_mm});
    ASSERT_EQ(there.modules.size(), here.modules.size()) << away_mm;
    EXPECT_EQ(there.islands, here.islands) << away_mm;
    for (std::size_t k = 0; k < here.modules.size(); ++k)
      EXPECT_EQ(there.modules[k].tile, here.modules[k].tile) << away_mm << " module " << k;
  }
}

}  // namespace
}  // namespace triskin::lattice

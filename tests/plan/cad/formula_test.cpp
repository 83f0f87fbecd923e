// SPDX-License-Identifier: GPL-3.0-or-later
// Parts with a formula, written by hand, are the only witness of geometry that shares nothing with the kernel.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "step_edits.hpp"
#include "triskin/cad/read_part.hpp"

namespace triskin::cad {
namespace {

using design::Vec3;
constexpr double kPi = std::numbers::pi;

double axis_distance(const Vec3& p) {
  return std::hypot(p.x(), p.y());
}

// Returns the largest distance of a face's triangles from its formula, at their corners and at a grid of places inside.
double deviation(const Part& part, const std::string& name, const std::function<double(const Vec3&)>& distance) {
  constexpr int kSteps = 6;
  double worst = 0.0;
  int triangles = 0;
  for (std::size_t t = 0; t < part.mesh.faces.size(); ++t) {
    if (part.faces[static_cast<std::size_t>(part.face_of_triangle[t])].name != name) continue;
    ++triangles;
    const auto at = [&](std::size_t k) { return part.mesh.vertices[static_cast<std::size_t>(part.mesh.faces[t][k])]; };
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        const double u = i / static_cast<double>(kSteps), v = j / static_cast<double>(kSteps);
        worst = std::max(worst, std::abs(distance(at(0) + u * (at(1) - at(0)) + v * (at(2) - at(0)))));
      }
    }
  }
  EXPECT_GT(triangles, 0) << name;
  return worst;
}

Part sound_part(const std::string& name, double area_mm2) {
  const Part part = read_part_bytes(test::part_file(name + ".step"), name);
  EXPECT_TRUE(part.faults.empty()) << (part.faults.empty() ? "" : part.faults.front());
  double area = 0.0;
  for (const Face& face : part.faces) area += face.area_mm2;
  EXPECT_NEAR(area, area_mm2, 1e-6 * area_mm2);
  return part;
}

// Places beside those that the mesher measured may lie a little beyond the requested limit.
constexpr double kLimit_mm = 0.05;

TEST(PartsWithAFormula, Cylinder) {
  const Part part = sound_part("cylinder", 2 * kPi * 40 * 120 + 2 * kPi * 40 * 40);
  EXPECT_LE(deviation(part, "side", [](const Vec3& p) { return axis_distance(p) - 40.0; }), kLimit_mm);
  EXPECT_LE(deviation(part, "top", [](const Vec3& p) { return p.z() - 120.0; }), 1e-9);
  EXPECT_EQ(part.faces[0].kind, SurfaceKind::kCylinder);
  EXPECT_NEAR(part.faces[0].radius_mm, 40.0, 1e-12);
  EXPECT_EQ(part.faces[0].side, FaceSide::kOutward);
  EXPECT_EQ(part.faces[0].hole_diameter_mm, 0.0);
}

TEST(PartsWithAFormula, Sphere) {
  const Part part = sound_part("sphere", 4 * kPi * 50 * 50);
  EXPECT_LE(deviation(part, "ball", [](const Vec3& p) { return p.norm() - 50.0; }), kLimit_mm);
}

TEST(PartsWithAFormula, Torus) {
  const Part part = sound_part("torus", 4 * kPi * kPi * 60 * 20);
  EXPECT_LE(deviation(part, "ring", [](const Vec3& p) { return std::hypot(axis_distance(p) - 60.0, p.z()) - 20.0; }),
            kLimit_mm);
}

// Returns the distance from the cone of base radius 40 and height 60, along its normal.
double cone_distance(const Vec3& p) {
  return (axis_distance(p) - 40.0 * (1.0 - p.z() / 60.0)) * 60.0 / std::hypot(40.0, 60.0);
}

TEST(PartsWithAFormula, ConeWithItsTip) {
  const Part part = sound_part("cone", kPi * 40 * std::hypot(40.0, 60.0) + kPi * 40 * 40);
  EXPECT_LE(deviation(part, "mantle", cone_distance), kLimit_mm);
}

// The kernel's own mesher leaves such a face empty.
TEST(PartsWithAFormula, ConeCutThroughItsTip) {
  const Part part = sound_part("half_cone", kPi * 40 * std::hypot(40.0, 60.0) / 2 + kPi * 40 * 40 / 2 + 40 * 60);
  EXPECT_LE(deviation(part, "mantle", cone_distance), kLimit_mm);
  EXPECT_EQ(part.bodies.front().open_edges, 0);
}

TEST(PartsWithAFormula, Fillet) {
  const Part part = sound_part("fillet", 2 * 40 * 80 + kPi / 2 * 10 * 80);
  EXPECT_LE(deviation(part, "fillet", [](const Vec3& p) { return std::hypot(p.x(), p.z()) - 10.0; }), kLimit_mm);
  EXPECT_FALSE(part.bodies.front().is_solid);
  EXPECT_EQ(part.bodies.front().free_edges, 8);
}

// The mesh must reach the fineness that was requested.
TEST(PartsWithAFormula, DeviationIsWhatWasAskedFor) {
  ReadOptions options;
  options.max_deviation_mm = 0.01;
  const Part part = read_part_bytes(test::part_file("cylinder.step"), "cylinder", options);
  EXPECT_LE(deviation(part, "side", [](const Vec3& p) { return axis_distance(p) - 40.0; }), 0.01);
}

TEST(PartsWithAFormula, UnitOverridesAndTheDeviationHoldsInMillimetres) {
  ReadOptions options;
  options.unit_mm = 25.4;
  const Part part = read_part_bytes(test::part_file("cylinder.step"), "cylinder", options);
  EXPECT_NEAR(part.faces[0].radius_mm, 40.0 * 25.4, 1e-9);
  EXPECT_LE(deviation(part, "side", [](const Vec3& p) { return axis_distance(p) - 40.0 * 25.4; }), kLimit_mm);
}

}  // namespace
}  // namespace triskin::cad

// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mesh/body_distance.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace triskin::mesh {
namespace {

// Returns a cube of 20 mm about a point.
Mesh cube(const Vec3& middle) {
  Mesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.vertices.push_back(middle + Vec3(k & 1 ? 10 : -10, k & 2 ? 10 : -10, k & 4 ? 10 : -10));
  mesh.faces = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

Mesh both(Mesh a, const Mesh& b) {
  const int first = static_cast<int>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& f : b.faces) a.faces.push_back({f[0] + first, f[1] + first, f[2] + first});
  return a;
}

TEST(BodyDistance, OfACube) {
  const BodyDistance body(cube(Vec3::Zero()));
  EXPECT_DOUBLE_EQ(body.signed_mm(Vec3(0, 0, 0)), -10.0);
  EXPECT_DOUBLE_EQ(body.signed_mm(Vec3(7, 1, 2)), -3.0);
  EXPECT_DOUBLE_EQ(body.signed_mm(Vec3(15, 3, -2)), 5.0);
  EXPECT_DOUBLE_EQ(body.signed_mm(Vec3(13, 14, 0)), 5.0);
  EXPECT_NEAR(body.signed_mm(Vec3(-12, 11, 12)), 3.0, 1e-12);
}

// The overlap of two cubes is inside both, but counting faces alone would take it for outside.
TEST(BodyDistance, BodiesThatOverlapAreOne) {
  const BodyDistance body(both(cube(Vec3::Zero()), cube(Vec3(12, 0, 0))));
  EXPECT_LT(body.signed_mm(Vec3(6, 0.3, 0.2)), 0.0);
  EXPECT_LT(body.signed_mm(Vec3(-6, 0, 0)), 0.0);
  EXPECT_GT(body.signed_mm(Vec3(23, 0, 0)), 0.0);
}

TEST(BodyDistance, ASheetHasNoInside) {
  Mesh open = cube(Vec3::Zero());
  open.faces.pop_back();
  EXPECT_GT(BodyDistance(open).signed_mm(Vec3(0, 0, 0)), 9.9);
}

// The lines pass the cube at 3 mm, run through its middle, and lead away from it.
TEST(BodyDistance, LeastAlongALine) {
  const BodyDistance body(cube(Vec3::Zero()));
  EXPECT_NEAR(body.least_along_mm(Vec3(-20, 13, 0), Vec3::UnitX(), 40.0, 100.0), 3.0, 1e-9);
  EXPECT_NEAR(body.least_along_mm(Vec3(-20, 0, 0), Vec3::UnitX(), 40.0, 100.0), -10.0, 0.1);
  EXPECT_NEAR(body.least_along_mm(Vec3(20, 0, 0), Vec3::UnitX(), 5.0, 100.0), 10.0, 1e-9);
  EXPECT_NEAR(body.least_along_mm(Vec3(4, 0, 0), Vec3::UnitX(), 0.0, 100.0), -6.0, 1e-9);
  const double bound = body.least_along_mm(Vec3(200, 0, 0), Vec3::UnitX(), 10.0, 5.0);
  EXPECT_GT(bound, 5.0);
  EXPECT_LE(bound, 190.0);
}

// Walks the line in steps of 0.01 mm, so that its least value is at most 0.005 mm above the true one.
TEST(BodyDistance, LeastAlongRandomLinesIsThatOfSmallSteps) {
  constexpr unsigned kSeed = 20261127;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> place(-25.0, 25.0), length(0.0, 60.0);
  Mesh sheet = cube(Vec3::Zero());
  sheet.faces.pop_back();
  for (const Mesh& mesh : {both(cube(Vec3::Zero()), cube(Vec3(12, 5, 3))), sheet}) {
    const BodyDistance body(mesh);
    for (int trial = 0; trial < 40; ++trial) {
      const auto any = [&] { return Vec3(place(random), place(random), place(random)); };
      const Vec3 from = any(), direction = any().normalized();
      const double length_mm = length(random);
      double least = body.signed_mm(from);
      for (double t = 0.0; t < length_mm; t += 0.01) least = std::min(least, body.signed_mm(from + t * direction));
      const double found = body.least_along_mm(from, direction, length_mm, 1e9);
      EXPECT_GE(found, least - 0.006) << "seed " << kSeed << ", trial " << trial;
      EXPECT_LE(found, least + 0.1) << "seed " << kSeed << ", trial " << trial;
    }
  }
}

}  // namespace
}  // namespace triskin::mesh

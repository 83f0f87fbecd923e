// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/mesh/body_distance.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace triskin::geometry {
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

}  // namespace
}  // namespace triskin::geometry

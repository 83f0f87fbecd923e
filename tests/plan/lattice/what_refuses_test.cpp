// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the reason why nothing fits, on shapes whose radius and width are known.
#include "triskin/lattice/what_refuses.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace triskin::lattice {
namespace {

using design::Mesh;
using design::Vec3;

// Maps a grid over [0, 1]² into space; the map sets the direction of the normals.
template <class Map>
mesh::Surface sheet(int across, int along, const Map& map) {
  Mesh mesh;
  for (int j = 0; j <= along; ++j) {
    for (int i = 0; i <= across; ++i) mesh.vertices.push_back(map(double(i) / across, double(j) / along));
  }
  const auto at = [&](int i, int j) { return j * (across + 1) + i; };
  for (int j = 0; j < along; ++j) {
    for (int i = 0; i < across; ++i) {
      mesh.faces.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.faces.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh::Surface(mesh);
}

// Makes most of a sphere, without the poles, seen from outside.
mesh::Surface sphere(double radius_mm) {
  return sheet(60, 30, [=](double u, double v) {
    const double a = 1.9 * M_PI * u, b = M_PI * (0.1 + 0.8 * v);
    return Vec3(radius_mm * std::sin(b) * std::cos(a), radius_mm * std::sin(b) * std::sin(a), -radius_mm * std::cos(b));
  });
}

// By docs/limits.md the centre gap, with the lift, allows a module on a sphere of 33 mm.
TEST(WhatRefuses, a_sphere_of_20_mm_needs_33) {
  const auto o = what_refuses(sphere(20.0), {});
  ASSERT_TRUE(o);
  EXPECT_EQ(o->limit, "center_gap_mm");
  EXPECT_NEAR(o->radius_mm, 20.0, 1.0);
  EXPECT_NEAR(o->needed_radius_mm, 900.0 / (6.0 * 4.5), 1.5);
  EXPECT_NEAR(o->needed_limit_mm, 900.0 / (6.0 * 20.0) - 1.5, 0.4);
}

TEST(WhatRefuses, a_strip_is_narrow_by_its_own_width) {
  const auto o = what_refuses(sheet(4, 40, [](double u, double v) { return Vec3(20 * u, 200 * v, 0); }), {});
  ASSERT_TRUE(o);
  EXPECT_EQ(o->limit, "narrow");
  EXPECT_NEAR(o->width_mm, 20.0, 1e-9);
}

TEST(WhatRefuses, nothing_is_said_of_a_plate_or_of_a_large_sphere) {
  EXPECT_FALSE(what_refuses(sheet(10, 10, [](double u, double v) { return Vec3(200 * u, 200 * v, 0); }), {}));
  EXPECT_FALSE(what_refuses(sphere(90.0), {}));
}

}  // namespace
}  // namespace triskin::lattice

// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/unfolding/developability.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "triskin/mesh/surface.hpp"

namespace triskin::unfolding {
namespace {

constexpr double kPi = std::numbers::pi;

// Returns a fan of n faces around the apex of a pyramid over a regular polygon of radius 1, height h.
Mesh fan(int n, double h) {
  Mesh mesh;
  mesh.vertices.emplace_back(0.0, 0.0, h);
  for (int k = 0; k < n; ++k) mesh.vertices.emplace_back(std::cos(2 * kPi * k / n), std::sin(2 * kPi * k / n), 0.0);
  for (int k = 0; k < n; ++k) mesh.faces.push_back({0, 1 + k, 1 + (k + 1) % n});
  return mesh;
}

TEST(TotalCurvature, of_a_plane_is_zero) {
  EXPECT_NEAR(total_curvature_rad(mesh::Surface(fan(7, 0.0))), 0.0, 1e-12);
}

// Four equilateral triangles leave 2π − 4 π/3.
TEST(TotalCurvature, of_the_tip_of_an_octahedron) {
  EXPECT_NEAR(total_curvature_rad(mesh::Surface(fan(4, 1.0))), 2.0 * kPi / 3.0, 1e-12);
}

// By Gauss–Bonnet every closed surface without a handle has 4π, whatever its edges.
TEST(TotalCurvature, of_a_tetrahedron_is_4_pi) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {0, 0, 5}};
  mesh.faces = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  EXPECT_NEAR(total_curvature_rad(mesh::Surface(mesh)), 4.0 * kPi, 1e-12);
}

// A saddle of eight faces of 60° around one vertex has −2π/3, which counts without its sign.
TEST(TotalCurvature, counts_saddles_too) {
  Mesh mesh;
  mesh.vertices.emplace_back(0.0, 0.0, 0.0);
  // Directions in turn up and down, each 60° from its neighbours: cos 45° cos²e − sin²e = 1/2.
  const double c = 1.0 / std::sqrt(2.0), cos2 = 1.5 / (1.0 + c);
  const double in_plane = std::sqrt(cos2), up = std::sqrt(1.0 - cos2);
  for (int k = 0; k < 8; ++k) {
    const double angle = kPi * k / 4.0;
    mesh.vertices.emplace_back(in_plane * std::cos(angle), in_plane * std::sin(angle), k % 2 == 0 ? up : -up);
  }
  for (int k = 0; k < 8; ++k) mesh.faces.push_back({0, 1 + k, 1 + (k + 1) % 8});
  EXPECT_NEAR(total_curvature_rad(mesh::Surface(mesh)), 2.0 * kPi / 3.0, 1e-12);
}

}  // namespace
}  // namespace triskin::unfolding

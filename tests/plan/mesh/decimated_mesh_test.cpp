// SPDX-License-Identifier: GPL-3.0-or-later
// Tests how much the mesh of the solvers may lose, and how far from the surface it may be. Distances are measured at
// random points and against every face.
#include "triskin/mesh/decimated_mesh.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <set>

#include "plan/lattice/shapes.hpp"
#include "plan/mesh/distances.hpp"
#include "triskin/lattice/grow_lattice.hpp"
#include "triskin/lattice/map_modules.hpp"

namespace triskin::mesh {
namespace {

constexpr double kRounding_mm = 1e-6;

Mesh square(double side_mm) {
  return {{{0, 0, 0}, {side_mm, 0, 0}, {side_mm, side_mm, 0}, {0, side_mm, 0}}, {{0, 1, 2}, {0, 2, 3}}};
}

Mesh cube(double side_mm) {
  Mesh m;
  for (int k = 0; k < 8; ++k) m.vertices.push_back(side_mm * Vec3(k & 1, (k >> 1) & 1, k >> 2));
  m.faces = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
             {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return m;
}

// Makes a plate of n × n cells of 100/n mm, without the middle ninth.
Mesh plate_with_hole(int n) {
  Mesh m = lattice::grid_mesh(n, n, [](double u, double v) { return Vec3(100 * u, 100 * v, 0.0); });
  std::erase_if(m.faces, [&](const auto& f) {
    const Vec3 p = (m.vertices[at(f[0])] + m.vertices[at(f[1])] + m.vertices[at(f[2])]) / 3.0;
    return std::max(std::abs(p.x() - 50.0), std::abs(p.y() - 50.0)) < 100.0 / 6.0;
  });
  return m;
}

Mesh torus(int n) {
  Mesh m;
  for (int v = 0; v < n; ++v) {
    for (int u = 0; u < n; ++u) {
      const double a = 2 * M_PI * u / n, b = 2 * M_PI * v / n, r = 60.0 + 25.0 * std::cos(b);
      m.vertices.emplace_back(r * std::cos(a), r * std::sin(a), 25.0 * std::sin(b));
      const auto id = [&](int x, int y) { return (y % n) * n + x % n; };
      m.faces.push_back({id(u, v), id(u + 1, v), id(u + 1, v + 1)});
      m.faces.push_back({id(u, v), id(u + 1, v + 1), id(u, v + 1)});
    }
  }
  return m;
}

double volume_of(const Mesh& m) {
  double six = 0.0;
  for (const auto& [a, b, c] : m.faces) six += m.vertices[at(a)].dot(m.vertices[at(b)].cross(m.vertices[at(c)]));
  return six / 6.0;
}

int euler_number(const Mesh& m) {
  std::set<std::pair<int, int>> edges;
  std::set<int> corners;
  for (const auto& f : m.faces) {
    for (std::size_t k = 0; k < 3; ++k) {
      edges.insert(std::minmax(f[k], f[(k + 1) % 3]));
      corners.insert(f[k]);
    }
  }
  return static_cast<int>(corners.size()) - static_cast<int>(edges.size()) + static_cast<int>(m.faces.size());
}

double distance_to_border(const Vec3& p, const Surface& s) {
  double best = 1e300;
  for (const auto& loop : s.border_loops()) {
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Vec3 &a = s.mesh().vertices[at(loop[k])], &b = s.mesh().vertices[at(loop[(k + 1) % loop.size()])];
      best = std::min(best, test::distance_to(p, a, b, b));
    }
  }
  return best;
}

// Measures at the corners and five places of each border edge of the first.
double border_distance(const Surface& from, const Surface& to) {
  double most = 0.0;
  for (const auto& loop : from.border_loops()) {
    for (std::size_t k = 0; k < loop.size(); ++k) {
      const Vec3 &a = from.mesh().vertices[at(loop[k])], &b = from.mesh().vertices[at(loop[(k + 1) % loop.size()])];
      for (int i = 0; i < 5; ++i) most = std::max(most, distance_to_border(a + 0.2 * i * (b - a), to));
    }
  }
  return most;
}

// Expects the stated bounds to hold at random points of both, and to be at most the requested ones.
void expect_bounds_hold(const Surface& original, const DecimatedMesh& solver, double asked_mm) {
  const Surface decimated(solver.mesh);
  test::Dice random(7);
  EXPECT_LE(test::sampled_distance(original.mesh(), solver.mesh, random, 4000), solver.deviation_mm + kRounding_mm);
  EXPECT_LE(test::sampled_distance(solver.mesh, original.mesh(), random, 400), solver.deviation_mm + kRounding_mm);
  EXPECT_LE(border_distance(original, decimated), solver.border_mm + kRounding_mm);
  EXPECT_LE(border_distance(decimated, original), solver.border_mm + kRounding_mm);
  EXPECT_LE(solver.deviation_mm, asked_mm);
  EXPECT_LE(solver.border_mm, kSolverBorder_mm);
}

TEST(DecimatedMesh, a_divided_square_becomes_two_faces) {
  const Surface original(lattice::divided(square(100.0), 6));
  ASSERT_EQ(original.mesh().faces.size(), 8192U);
  const DecimatedMesh solver = decimate(original);
  EXPECT_EQ(solver.mesh.faces.size(), 2U);
  EXPECT_LT(solver.deviation_mm, kRounding_mm);
  EXPECT_LT(solver.border_mm, kRounding_mm);
  EXPECT_DOUBLE_EQ(Surface(solver.mesh).area_mm2(), 10'000.0);
}

TEST(DecimatedMesh, a_divided_cube_becomes_twelve_faces) {
  const DecimatedMesh solver = decimate(Surface(lattice::divided(cube(80.0), 5)));
  EXPECT_EQ(solver.mesh.faces.size(), 12U);
  EXPECT_EQ(solver.mesh.vertices.size(), 8U);
  EXPECT_NEAR(volume_of(solver.mesh), 512'000.0, 1e-6);
  EXPECT_LT(solver.deviation_mm, kRounding_mm);
}

TEST(DecimatedMesh, a_divided_cylinder_keeps_within_the_deviation) {
  const double r = 50.0;
  const Surface original(lattice::grid_mesh(
      300, 20, [=](double u, double v) { return Vec3(r * std::cos(M_PI * u), 100.0 * v, r * std::sin(M_PI * u)); }));
  for (const auto& [asked_mm, most] : {std::pair{0.2, 600U}, {0.05, 1'500U}, {0.01, 5'000U}}) {
    const DecimatedMesh solver = decimate(original, asked_mm);
    expect_bounds_hold(original, solver, asked_mm);
    // Chords of a circle that deviate by d are √(8 r d) long, so no mesh with corners on it has fewer strips of two
    // faces.
    const double fewest = 2.0 * M_PI * r / std::sqrt(8.0 * r * asked_mm);
    EXPECT_GT(static_cast<double>(solver.mesh.faces.size()), 0.9 * fewest);
    EXPECT_LT(solver.mesh.faces.size(), most) << asked_mm;
  }
}

TEST(DecimatedMesh, a_bent_sheet_keeps_within_the_deviation) {
  const Surface original(lattice::grid_mesh(
      100, 100, [](double u, double v) { return Vec3(200 * u, 200 * v, 12.0 * std::sin(5 * u) * std::cos(6 * v)); }));
  const DecimatedMesh solver = decimate(original);
  expect_bounds_hold(original, solver, kSolverDeviation_mm);
  EXPECT_LT(solver.mesh.faces.size(), original.mesh().faces.size() / 2);
}

TEST(DecimatedMesh, a_hole_stays) {
  const Surface original(plate_with_hole(60));
  ASSERT_EQ(original.border_loops().size(), 2U);
  const DecimatedMesh solver = decimate(original);
  const Surface decimated(solver.mesh);
  EXPECT_EQ(decimated.border_loops().size(), 2U);
  EXPECT_EQ(solver.mesh.faces.size(), 8U);  // There are eight corners, and a ring has as many faces.
  EXPECT_NEAR(decimated.area_mm2(), original.area_mm2(), 1e-6);
  expect_bounds_hold(original, solver, kSolverDeviation_mm);
}

// A hole that is narrower than the bounds is reduced to three corners, but not closed.
TEST(DecimatedMesh, a_slit_stays) {
  Mesh m = lattice::grid_mesh(40, 40, [](double u, double v) { return Vec3(100 * u, 100 * v, 0.0); });
  std::map<int, int> upper;  // These are copies of the corners between the ends of the slit.
  for (int u = 11; u < 30; ++u) {
    const int v = 20 * 41 + u;
    upper[v] = static_cast<int>(m.vertices.size());
    m.vertices.emplace_back(m.vertices[at(v)] + Vec3(0.0, 0.002, 0.0));
    m.vertices[at(v)].y() -= 0.002;
  }
  for (auto& f : m.faces) {
    if ((m.vertices[at(f[0])] + m.vertices[at(f[1])] + m.vertices[at(f[2])]).y() < 150.0) continue;
    for (int& v : f) v = upper.contains(v) ? upper.at(v) : v;
  }
  const Surface original(m);
  ASSERT_EQ(original.border_loops().size(), 2U);
  const DecimatedMesh solver = decimate(original);
  const Surface decimated(solver.mesh);
  ASSERT_EQ(decimated.border_loops().size(), 2U);
  EXPECT_EQ(decimated.border_loops()[0].size() + decimated.border_loops()[1].size(), 7U);
  expect_bounds_hold(original, solver, kSolverDeviation_mm);
}

TEST(DecimatedMesh, a_round_border_stays_within_its_bound) {
  Mesh m = lattice::grid_mesh(720, 24, [](double u, double v) {
    return Vec3((20 + 30 * v) * Vec3(std::cos(2 * M_PI * u), -std::sin(2 * M_PI * u), 0.0));
  });
  m = test::read_back(m);  // After welding it is a disc with a round hole.
  const Surface original(m);
  ASSERT_EQ(original.border_loops().size(), 2U);
  const DecimatedMesh solver = decimate(original);
  expect_bounds_hold(original, solver, kSolverDeviation_mm);
  EXPECT_GT(solver.border_mm, 0.002);  // Without this the test would prove nothing.
  EXPECT_LT(solver.mesh.faces.size(), 2'000U);
}

TEST(DecimatedMesh, a_handle_stays) {
  const Surface original(torus(80));
  const DecimatedMesh solver = decimate(original);
  EXPECT_EQ(euler_number(original.mesh()), 0);
  EXPECT_EQ(euler_number(solver.mesh), 0);
  EXPECT_TRUE(Surface(solver.mesh).border_loops().empty());
  expect_bounds_hold(original, solver, kSolverDeviation_mm);
}

// Two squares meet in nothing but one vertex.
TEST(DecimatedMesh, a_corner_where_borders_meet_stays) {
  Mesh m = lattice::divided(square(50.0), 4);
  const Mesh one = m;
  std::vector<int> number;
  for (const Vec3& v : one.vertices) {
    number.push_back(v.norm() > 0.0 ? static_cast<int>(m.vertices.size()) : 0);
    if (v.norm() > 0.0) m.vertices.push_back(-v);
  }
  for (const auto& f : one.faces) m.faces.push_back({number[at(f[0])], number[at(f[1])], number[at(f[2])]});
  const DecimatedMesh solver = decimate(Surface(m));
  EXPECT_NEAR(Surface(solver.mesh).area_mm2(), 5'000.0, 1e-6);
  EXPECT_LT(solver.mesh.faces.size(), 20U);
  EXPECT_LT(solver.mesh.vertices[0].norm(), 1e-12);
}

TEST(DecimatedMesh, is_the_same_whatever_the_number_of_threads) {
  const Surface original(torus(90));
  const DecimatedMesh one = decimate(original, 0.05, 0.01, 1), three = decimate(original, 0.05, 0.01, 3);
  EXPECT_EQ(one.mesh.faces, three.mesh.faces);
  EXPECT_EQ(one.mesh.vertices, three.mesh.vertices);
  EXPECT_EQ(one.deviation_mm, three.deviation_mm);
}

TEST(DecimatedMesh, nothing_goes_without_a_deviation) {
  const Surface original(lattice::divided(square(100.0), 4));
  EXPECT_EQ(decimate(original, 0.0).mesh.faces, original.mesh().faces);
}

TEST(DecimatedMesh, the_surface_itself_serves_where_its_faces_are_wide_or_few) {
  const LayoutLimits limits;
  EXPECT_FALSE(
      solver_mesh_of(Surface(lattice::divided(square(20.0), 5)), limits));  // There are 2,048 faces of 0.2 mm².
  EXPECT_FALSE(
      solver_mesh_of(Surface(lattice::divided(square(300.0), 6)), limits));  // There are 8,192 faces of 11 mm².
  const Surface fine(lattice::divided(square(100.0), 6));
  EXPECT_FALSE(solver_mesh_of(fine, limits, 0.0));
  ASSERT_TRUE(solver_mesh_of(fine, limits));
  EXPECT_EQ(solver_mesh_of(fine, limits)->mesh.faces.size(), 2U);
}

TEST(DecimatedMesh, takes_a_twentieth_of_a_narrow_limit) {
  const Surface original(torus(200));
  LayoutLimits narrow;
  narrow.lift_mm = 0.8;
  const auto solver = solver_mesh_of(original, narrow, 0.5);
  ASSERT_TRUE(solver);
  EXPECT_LE(solver->deviation_mm, 0.04);
  EXPECT_DOUBLE_EQ(limits_on(*solver, narrow).lift_mm, 0.8 - solver->deviation_mm);
  const DecimatedMesh coarse{{}, 1.0, 1.0};
  EXPECT_DOUBLE_EQ(limits_on(coarse, narrow).lift_mm, 0.4);
  EXPECT_DOUBLE_EQ(limits_on(coarse, {}).overrun_mm, 0.25);
}

// The search uses only the solver's mesh; its modules are measured on the surface, and none is lost there.
TEST(DecimatedMesh, a_layout_is_measured_on_the_surface) {
  const Surface original(lattice::grid_mesh(
      120, 120, [](double u, double v) { return Vec3(160 * u, 160 * v, 10.0 * std::sin(3 * u) * std::cos(4 * v)); }));
  const auto solver = solver_mesh_of(original, {});
  ASSERT_TRUE(solver);
  lattice::SurfaceLatticeOptions options = lattice::effort(30);
  options.front = false;
  options.solver = &*solver;
  ModuleLayout layout = lattice::grow_lattice(original, {}, options);
  EXPECT_GT(layout.modules.size(), 40U);
  const ModuleLayout stated = layout;
  lattice::measure(original, layout);
  for (std::size_t k = 0; k < layout.modules.size(); ++k) {
    EXPECT_DOUBLE_EQ(layout.modules[k].center_gap_mm, stated.modules[k].center_gap_mm);
    EXPECT_DOUBLE_EQ(layout.modules[k].edge_lift_mm, stated.modules[k].edge_lift_mm);
    EXPECT_DOUBLE_EQ(layout.modules[k].overrun_mm, stated.modules[k].overrun_mm);
    EXPECT_LE(layout.modules[k].overrun_mm, LayoutLimits{}.overrun_mm);
  }
}

}  // namespace
}  // namespace triskin::mesh

// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <functional>

#include "triskin/base/error.hpp"
#include "triskin/mesh/extract.hpp"
#include "triskin/placement/polygon_io.hpp"
#include "triskin/unfolding/unfolding.hpp"

namespace triskin::unfolding {
namespace {

// Maps a grid over [0, 1]² into space, with `n` cells per side.
Mesh sheet(int n, const std::function<Vec3(double, double)>& map) {
  Mesh mesh;
  for (int v = 0; v <= n; ++v) {
    for (int u = 0; u <= n; ++u) mesh.vertices.push_back(map(static_cast<double>(u) / n, static_cast<double>(v) / n));
  }
  for (int v = 0; v < n; ++v) {
    for (int u = 0; u < n; ++u) {
      const int k = v * (n + 1) + u;
      mesh.faces.push_back({k, k + 1, k + n + 1});
      mesh.faces.push_back({k + 1, k + n + 2, k + n + 1});
    }
  }
  return mesh;
}

double flat_area(const Net& net) {
  double area = 0;
  for (const Piece& p : net.pieces) area += placement::polygon_area(p.outline);
  return area;
}

TEST(Unfold, a_plane_stays_one_piece_without_error) {
  const mesh::Surface s(sheet(10, [](double u, double v) { return Vec3(100 * u, 80 * v, 30 * u); }));
  const Net net = unfold(s);
  ASSERT_EQ(net.pieces.size(), 1U);
  EXPECT_LT(net.pieces[0].max_edge_error_mm, 1e-9);
  EXPECT_NEAR(flat_area(net), s.area_mm2(), 1e-6);
}

TEST(Unfold, cylinder_and_cone_are_developable) {
  const auto cylinder = [](double u, double v) { return Vec3(60 * std::cos(3 * u), 60 * std::sin(3 * u), 120 * v); };
  const auto cone = [](double u, double v) {
    const double r = 40 + 30 * v;
    return Vec3(r * std::cos(3 * u), r * std::sin(3 * u), 100 * v);
  };
  for (const auto& map : {std::function<Vec3(double, double)>(cylinder), std::function<Vec3(double, double)>(cone)}) {
    const mesh::Surface s(sheet(24, map));
    const Net net = unfold(s);
    ASSERT_EQ(net.pieces.size(), 1U);
    EXPECT_LT(net.pieces[0].max_edge_error_mm, 0.02);
    EXPECT_NEAR(flat_area(net) / s.area_mm2(), 1.0, 1e-3);
  }
}

TEST(Unfold, a_closed_tube_is_cut_without_help) {
  Mesh mesh = sheet(
      24, [](double u, double v) { return Vec3(50 * std::cos(2 * M_PI * u), 50 * std::sin(2 * M_PI * u), 120 * v); });
  // Welding the seam makes column 24 equal to column 0.
  for (auto& f : mesh.faces) {
    for (int& v : f) {
      if (v % 25 == 24) v -= 24;
    }
  }
  const mesh::Surface s(mesh::extract(mesh).surface);
  EXPECT_EQ(s.border_loops().size(), 2U);
  const Net net = unfold(s);
  EXPECT_GE(net.pieces.size(), 1U);
  EXPECT_LE(net.pieces.size(), 2U);
  for (const Piece& p : net.pieces) EXPECT_LT(p.max_edge_error_mm, 0.1);
  EXPECT_NEAR(flat_area(net) / s.area_mm2(), 1.0, 1e-3);
}

// Maps a polar grid over a disc of radius ρ (arc length from the middle), 16 rings of 48 sectors, into space.
Mesh disc(double rho_mm, const std::function<Vec3(double, double)>& map) {
  constexpr int kRings = 16, kSectors = 48;
  Mesh mesh;
  mesh.vertices.push_back(map(0, 0));
  for (int r = 1; r <= kRings; ++r) {
    for (int k = 0; k < kSectors; ++k) mesh.vertices.push_back(map(rho_mm * r / kRings, 2 * M_PI * k / kSectors));
  }
  const auto at = [](int r, int k) { return 1 + (r - 1) * kSectors + k % kSectors; };
  for (int k = 0; k < kSectors; ++k) {
    mesh.faces.push_back({0, at(1, k), at(1, k + 1)});
    for (int r = 1; r < kRings; ++r) {
      mesh.faces.push_back({at(r, k), at(r + 1, k), at(r + 1, k + 1)});
      mesh.faces.push_back({at(r, k), at(r + 1, k + 1), at(r, k + 1)});
    }
  }
  return mesh;
}

Mesh cap(double radius_mm, double rho_mm) {
  return disc(rho_mm, [=](double r, double a) {
    const double polar = r / radius_mm;
    return Vec3(radius_mm * std::sin(polar) * std::cos(a), radius_mm * std::sin(polar) * std::sin(a),
                radius_mm * std::cos(polar));
  });
}

// The sum of squares leaves a·K·ρ²/8 at the border (docs/unfolding.md).
TEST(Unfold, a_spherical_cap_has_the_error_of_the_formula) {
  for (const double radius : {50.0, 75.0, 100.0, 125.0, 150.0}) {
    for (const double share : {0.2, 0.35}) {
      const double rho = share * radius;
      const Net net = unfold(mesh::Surface(cap(radius, rho)), {.edge_error_mm = 20.0});
      ASSERT_EQ(net.pieces.size(), 1U);
      const double formula = 30.0 * rho * rho / (8 * radius * radius);
      EXPECT_NEAR(net.pieces[0].max_edge_error_mm / formula, 1.0, 0.12)
          << "radius " << radius << " mm, cap " << rho << " mm";
    }
  }
}

// Evened out, the largest error is a·K·ρ²/12: a limit 15 % over it needs no cut, one 15 % under it needs one.
TEST(Unfold, a_cap_is_cut_where_the_least_error_passes_the_limit) {
  for (const double radius : {50.0, 100.0, 150.0}) {
    const double rho = 0.35 * radius, least = 30.0 * rho * rho / (12 * radius * radius);
    const mesh::Surface s(cap(radius, rho));
    const Net within = unfold(s, {.edge_error_mm = 1.15 * least});
    EXPECT_EQ(within.pieces.size(), 1U) << radius;
    EXPECT_GT(unfold(s, {.edge_error_mm = 0.85 * least, .darts = 0}).pieces.size(), 1U) << radius;
  }
}

// A dart to the middle lets a cap open into a cone, so it stays one piece at an error for which it would be divided.
TEST(Unfold, a_dart_saves_a_division) {
  for (const double radius : {50.0, 100.0, 150.0}) {
    const double rho = 0.35 * radius, least = 30.0 * rho * rho / (12 * radius * radius);
    const mesh::Surface s(cap(radius, rho));
    const Net net = unfold(s, {.edge_error_mm = 0.85 * least});
    ASSERT_EQ(net.pieces.size(), 1U) << radius;
    EXPECT_LE(net.pieces[0].max_edge_error_mm, 0.85 * least);
    EXPECT_EQ(net.pieces[0].faces.size(), s.mesh().faces.size());
    EXPECT_GT(unfold(s, {.edge_error_mm = 0.85 * least, .darts = 0}).pieces.size(), 1U);
  }
}

// The saddle z = xy/R has K ≈ −1/R² near the middle, with the same least error as on the sphere.
TEST(Unfold, a_saddle_has_the_error_of_its_curvature) {
  const double radius = 150.0, rho = 40.0;
  const mesh::Surface s(disc(rho, [=](double r, double a) {
    const double x = r * std::cos(a), y = r * std::sin(a);
    return Vec3(x, y, x * y / radius);
  }));
  const Net net = unfold(s, {.edge_error_mm = 20.0});
  ASSERT_EQ(net.pieces.size(), 1U);
  const double formula = 30.0 * rho * rho / (8 * radius * radius);
  EXPECT_NEAR(net.pieces[0].max_edge_error_mm / formula, 1.0, 0.25);
}

// A whole torus is closed and has both signs of curvature: it must be divided automatically, with every piece within
// the limit.
TEST(Unfold, a_torus_comes_apart_by_itself) {
  constexpr int kN = 32;
  Mesh mesh;
  for (int v = 0; v < kN; ++v) {
    for (int u = 0; u < kN; ++u) {
      const double a = 2 * M_PI * u / kN, b = 2 * M_PI * v / kN;
      mesh.vertices.emplace_back((120 + 40 * std::cos(b)) * std::cos(a), (120 + 40 * std::cos(b)) * std::sin(a),
                                 40 * std::sin(b));
    }
  }
  for (int v = 0; v < kN; ++v) {
    for (int u = 0; u < kN; ++u) {
      const int w = (v + 1) % kN, t = (u + 1) % kN;
      mesh.faces.push_back({v * kN + u, v * kN + t, w * kN + t});
      mesh.faces.push_back({v * kN + u, w * kN + t, w * kN + u});
    }
  }
  const mesh::Surface s(mesh);
  EXPECT_TRUE(s.border_loops().empty());
  const Net net = unfold(s);
  for (const Piece& p : net.pieces) EXPECT_LE(p.max_edge_error_mm, 1.0);
  EXPECT_LE(net.pieces.size(), 24U);
  EXPECT_NEAR(flat_area(net) / s.area_mm2(), 1.0, 0.02);
}

// A rigid motion or a mirror changes neither the number of pieces much nor the area.
TEST(Unfold, moved_and_mirrored_copies_unfold_alike) {
  const Mesh mesh = cap(70.0, 80.0);
  const Net net = unfold(mesh::Surface(mesh));
  const Eigen::AngleAxisd turn(1.1, Vec3(1, 2, 3).normalized());
  Mesh moved = mesh, mirrored = mesh;
  for (Vec3& v : moved.vertices) v = turn * v + Vec3(400, -30, 7);
  for (Vec3& v : mirrored.vertices) v.x() = -v.x();
  for (auto& f : mirrored.faces) std::swap(f[0], f[1]);
  for (const Mesh& copy : {moved, mirrored}) {
    const Net other = unfold(mesh::Surface(copy));
    EXPECT_NEAR(static_cast<double>(other.pieces.size()), static_cast<double>(net.pieces.size()), 1.0);
    EXPECT_NEAR(flat_area(other) / flat_area(net), 1.0, 0.01);
  }
}

TEST(Unfold, a_tighter_limit_gives_more_pieces_and_keeps_the_limit) {
  const mesh::Surface s(sheet(20, [](double u, double v) {
    const double x = 160 * (u - 0.5), y = 160 * (v - 0.5);
    return Vec3(x, y, std::sqrt(130.0 * 130.0 - x * x - y * y));
  }));
  std::size_t before = 0;
  for (const double limit : {4.0, 1.0, 0.25}) {
    const Net net = unfold(s, {.edge_error_mm = limit});
    for (const Piece& p : net.pieces) EXPECT_LE(p.max_edge_error_mm, limit);
    EXPECT_GE(net.pieces.size(), before);
    before = net.pieces.size();
    std::size_t faces = 0;
    for (const Piece& p : net.pieces) faces += p.faces.size();
    EXPECT_EQ(faces, s.mesh().faces.size());
  }
  EXPECT_GT(before, 1U);
}

TEST(Extract, turns_faces_that_disagree_and_splits_a_third_face_off) {
  Mesh mesh = sheet(6, [](double u, double v) { return Vec3(100 * u, 100 * v, 0); });
  std::swap(mesh.faces[7][0], mesh.faces[7][1]);
  const int a = mesh.faces[20][0], b = mesh.faces[20][1];
  mesh.vertices.emplace_back(50, 50, 20);  // The mesh has a fin on an inner edge.
  mesh.faces.push_back({a, b, static_cast<int>(mesh.vertices.size()) - 1});
  EXPECT_THROW(mesh::require_manifold(mesh, "fin.obj"), InputError);
  const mesh::Extraction e = mesh::extract(mesh);
  EXPECT_EQ(e.report.flipped_faces, 1);
  const mesh::Surface s(e.surface);
  EXPECT_NEAR(s.area_mm2(), 10000.0, 1e-6);
  EXPECT_EQ(s.border_loops().size(), 1U);
}

TEST(Extract, a_surface_through_itself_is_named_with_its_place) {
  Mesh mesh = sheet(4, [](double u, double v) { return Vec3(100 * u, 100 * v, 0); });
  EXPECT_NO_THROW(mesh::require_no_self_intersection(mesh, "flat.obj"));
  const Mesh other = sheet(4, [](double u, double v) { return Vec3(100 * u, 47, 100 * v - 50); });
  const int base = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& f : other.faces) mesh.faces.push_back({f[0] + base, f[1] + base, f[2] + base});
  try {
    mesh::require_no_self_intersection(mesh, "cross.obj");
    ADD_FAILURE();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("cross.obj"), std::string::npos);
  }
}

}  // namespace
}  // namespace triskin::unfolding

// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/geometry/unfolding.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "triskin/geometry/extract.hpp"
#include "triskin/geometry/polygon_io.hpp"
#include "triskin/host/error.hpp"

namespace triskin::geometry {
namespace {

// Grid over [0, 1]² mapped into space, `n` cells a side.
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
  for (const Piece& p : net.pieces) area += polygon_area(p.outline);
  return area;
}

TEST(Unfold, a_plane_stays_one_piece_without_error) {
  const Surface s(sheet(10, [](double u, double v) { return Vec3(100 * u, 80 * v, 30 * u); }));
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
    const Surface s(sheet(24, map));
    const Net net = unfold(s);
    ASSERT_EQ(net.pieces.size(), 1U);
    EXPECT_LT(net.pieces[0].max_edge_error_mm, 0.02);
    EXPECT_NEAR(flat_area(net) / s.area_mm2(), 1.0, 1e-3);
  }
}

TEST(Unfold, a_closed_tube_is_cut_without_help) {
  Mesh mesh = sheet(24, [](double u, double v) { return Vec3(50 * std::cos(2 * M_PI * u), 50 * std::sin(2 * M_PI * u), 120 * v); });
  // Weld the seam: column 24 is column 0.
  for (auto& f : mesh.faces) {
    for (int& v : f) {
      if (v % 25 == 24) v -= 24;
    }
  }
  const Surface s(extract(mesh).surface);
  EXPECT_EQ(s.border_loops().size(), 2U);
  const Net net = unfold(s);
  EXPECT_GE(net.pieces.size(), 1U);
  EXPECT_LE(net.pieces.size(), 2U);
  for (const Piece& p : net.pieces) EXPECT_LT(p.max_edge_error_mm, 0.1);
  EXPECT_NEAR(flat_area(net) / s.area_mm2(), 1.0, 1e-3);
}

// Largest edge error of a disc of radius ρ on a sphere: a·ρ²/(12·R²) within some 20 % (docs/unfolding.md).
TEST(Unfold, a_spherical_cap_has_the_error_of_the_formula) {
  for (const double radius : {100.0, 150.0}) {
    constexpr double kRho = 50.0;
    Mesh mesh;
    mesh.vertices.emplace_back(0, 0, radius);
    constexpr int kRings = 16, kSectors = 48;
    for (int r = 1; r <= kRings; ++r) {
      const double polar = kRho / radius * r / kRings;
      for (int k = 0; k < kSectors; ++k) {
        const double a = 2 * M_PI * k / kSectors;
        mesh.vertices.emplace_back(radius * std::sin(polar) * std::cos(a), radius * std::sin(polar) * std::sin(a), radius * std::cos(polar));
      }
    }
    const auto at = [](int r, int k) { return 1 + (r - 1) * kSectors + k % kSectors; };
    for (int k = 0; k < kSectors; ++k) {
      mesh.faces.push_back({0, at(1, k), at(1, k + 1)});
      for (int r = 1; r < kRings; ++r) {
        mesh.faces.push_back({at(r, k), at(r + 1, k), at(r + 1, k + 1)});
        mesh.faces.push_back({at(r, k), at(r + 1, k + 1), at(r, k + 1)});
      }
    }
    const Net net = unfold(Surface(mesh), {.edge_error_mm = 3.0});
    ASSERT_EQ(net.pieces.size(), 1U);
    const double formula = 30.0 * kRho * kRho / (12 * radius * radius);
    EXPECT_NEAR(net.pieces[0].max_edge_error_mm / formula, 1.0, 0.6) << radius;
  }
}

TEST(Unfold, a_tighter_limit_gives_more_pieces_and_keeps_the_limit) {
  const Surface s(sheet(20, [](double u, double v) {
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
  mesh.vertices.emplace_back(50, 50, 20);  // a fin on an inner edge
  mesh.faces.push_back({a, b, static_cast<int>(mesh.vertices.size()) - 1});
  EXPECT_THROW(require_manifold(mesh, "fin.obj"), InputError);
  const Extraction e = extract(mesh);
  EXPECT_EQ(e.report.flipped_faces, 1);
  const Surface s(e.surface);
  EXPECT_NEAR(s.area_mm2(), 10000.0, 1e-6);
  EXPECT_EQ(s.border_loops().size(), 1U);
}

TEST(Extract, a_surface_through_itself_is_named_with_its_place) {
  Mesh mesh = sheet(4, [](double u, double v) { return Vec3(100 * u, 100 * v, 0); });
  EXPECT_NO_THROW(require_no_self_intersection(mesh, "flat.obj"));
  const Mesh other = sheet(4, [](double u, double v) { return Vec3(100 * u, 47, 100 * v - 50); });
  const int base = static_cast<int>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& f : other.faces) mesh.faces.push_back({f[0] + base, f[1] + base, f[2] + base});
  try {
    require_no_self_intersection(mesh, "cross.obj");
    ADD_FAILURE();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("cross.obj"), std::string::npos);
  }
}

}  // namespace
}  // namespace triskin::geometry

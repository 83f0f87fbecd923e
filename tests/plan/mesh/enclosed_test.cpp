// SPDX-License-Identifier: GPL-3.0-or-later
// No module can be placed on parts in a closed part. CGAL tells what lies inside.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "solids.hpp"
#include "triskin/mesh/extract.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::mesh {
namespace {

using test::both, test::cube, test::inside_out;
using When = ExtractOptions::When;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<Kernel::Point_3>;

// Extracts with the options of design().
Extraction extracted(const Mesh& mesh, When outer = When::kWhenNeeded) {
  ExtractOptions o;
  o.repair = o.keep_usable = true;
  o.outer = o.wrap = outer;
  return extract(mesh, o);
}

double area(const Mesh& m) {
  return Surface(m).area_mm2();
}

Mesh ball(const Vec3& middle, const Vec3& radii) {
  Mesh m = cube(Vec3::Zero(), 2.0, 4);
  for (Vec3& v : m.vertices) v = middle + radii.cwiseProduct(v.normalized());
  return m;
}

Mesh ring(double radius, double thickness) {
  constexpr int kAround = 24, kAcross = 12;
  Mesh m;
  for (int i = 0; i < kAround; ++i) {
    for (int j = 0; j < kAcross; ++j) {
      const double u = 2.0 * M_PI * i / kAround, v = 2.0 * M_PI * j / kAcross, r = radius + thickness * std::cos(v);
      m.vertices.emplace_back(r * std::cos(u), r * std::sin(u), thickness * std::sin(v));
      const auto index = [&](int k, int l) { return (k % kAround) * kAcross + l % kAcross; };
      m.faces.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
      m.faces.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
    }
  }
  return m;
}

CgalMesh cgal_mesh(const Mesh& m) {
  CgalMesh result;
  for (const Vec3& v : m.vertices) result.add_vertex({v.x(), v.y(), v.z()});
  using Vertex = CgalMesh::Vertex_index;
  for (const auto& f : m.faces) {
    result.add_face(Vertex(static_cast<unsigned>(f[0])), Vertex(static_cast<unsigned>(f[1])),
                    Vertex(static_cast<unsigned>(f[2])));
  }
  return result;
}

TEST(Enclosed, cavity_of_a_hollow_box_goes) {
  const Mesh hollow = both(cube(Vec3::Zero(), 200.0), inside_out(cube(Vec3::Zero(), 120.0)));
  const Extraction e = extracted(hollow);
  EXPECT_EQ(e.report.enclosed_components, 1);
  EXPECT_EQ(e.report.components, 1);
  EXPECT_EQ(e.report.repair, Repair::kNone);
  EXPECT_NEAR(area(e.surface), 6.0 * 200.0 * 200.0, 1e-6);
  EXPECT_TRUE(usable(e.surface));
  const Extraction all = extracted(hollow, When::kNever);
  EXPECT_EQ(all.report.enclosed_components, 0);
  EXPECT_NEAR(area(all.surface), 6.0 * (200.0 * 200.0 + 120.0 * 120.0), 1e-6);
}

TEST(Enclosed, every_shell_but_the_outermost_goes_whatever_its_side) {
  const Mesh three =
      both(both(cube(Vec3::Zero(), 120.0), inside_out(cube(Vec3::Zero(), 200.0))), cube(Vec3::Zero(), 160.0));
  const Extraction e = extracted(three);
  EXPECT_EQ(e.report.enclosed_components, 2);
  EXPECT_NEAR(area(e.surface), 6.0 * 200.0 * 200.0, 1e-6);
  const Surface s(e.surface);
  EXPECT_GT(
      s.face_normal(design::FaceIndex{0}).dot(e.surface.vertices[static_cast<std::size_t>(e.surface.faces[0][0])]),
      0.0);
}

TEST(Enclosed, what_can_be_reached_stays) {
  // The cube lies in the hole of a ring: inside its box but not inside it.
  const Extraction in_hole = extracted(both(ring(150.0, 30.0), cube(Vec3::Zero(), 40.0)));
  EXPECT_EQ(in_hole.report.enclosed_components, 0);
  EXPECT_EQ(in_hole.report.components, 2);
  // The part lies in a box without a lid.
  Mesh open = cube(Vec3::Zero(), 200.0);
  std::erase_if(open.faces, [&](const auto& f) {
    return std::ranges::all_of(f, [&](int v) { return open.vertices[static_cast<std::size_t>(v)].z() > 99.0; });
  });
  const Extraction in_open = extracted(both(open, cube(Vec3::Zero(), 120.0)));
  EXPECT_EQ(in_open.report.enclosed_components, 0);
  EXPECT_EQ(in_open.report.components, 2);
}

TEST(Enclosed, agrees_with_cgal_on_random_balls) {
  std::mt19937_64 random(20261123);
  std::uniform_real_distribution<double> place(-150.0, 150.0), radius(60.0, 220.0);
  int scenes = 0, enclosed_in_all = 0;
  while (scenes < 100) {
    std::vector<Mesh> parts;
    Mesh all;
    for (int k = 0; k < 5; ++k) {
      const double spread = 1.0 / (k + 1);  // Later ones are smaller, and many lie in an earlier one.
      const Vec3 middle = spread * Vec3(place(random), place(random), place(random));
      Mesh part = ball(middle, spread * Vec3(radius(random), radius(random), radius(random)));
      if (random() % 2 == 0) part = inside_out(part);
      const Mesh with = both(all, part);
      if (CGAL::Polygon_mesh_processing::does_self_intersect(cgal_mesh(with))) continue;
      parts.push_back(part);
      all = with;
    }
    if (parts.size() < 2) continue;
    ++scenes;
    double expected_mm2 = 0.0;
    int enclosed = 0;
    for (const Mesh& part : parts) {
      const Vec3& v = part.vertices.front();
      const bool is_enclosed = std::ranges::any_of(parts, [&](const Mesh& other) {
        if (&other == &part) return false;
        const CgalMesh mesh = cgal_mesh(other);
        const CGAL::Side_of_triangle_mesh<CgalMesh, Kernel> side(mesh);
        return side({v.x(), v.y(), v.z()}) == CGAL::ON_BOUNDED_SIDE;
      });
      if (is_enclosed) {
        ++enclosed;
      } else {
        expected_mm2 += area(part);
      }
    }
    const Extraction e = extracted(all);
    EXPECT_EQ(e.report.enclosed_components, enclosed) << "scene " << scenes;
    EXPECT_NEAR(area(e.surface), expected_mm2, 1e-9 * expected_mm2) << "scene " << scenes;
    enclosed_in_all += enclosed;
  }
  EXPECT_GT(enclosed_in_all, 20);  // Without this the scenes would prove nothing.
}

}  // namespace
}  // namespace triskin::mesh

// SPDX-License-Identifier: GPL-3.0-or-later
// The search for faces that cross must find the pairs that CGAL's finds, and those worked out by hand.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>

#include "plan/mesh/broken_meshes.hpp"
#include "plan/mesh/distances.hpp"
#include "plan/mesh/src/crossing_search.hpp"
#include "triskin/base/error.hpp"

namespace triskin {
namespace {

using design::Mesh;
using design::Vec3;
using mesh::find_crossings;
using Pairs = std::vector<std::pair<int, int>>;

Pairs crossings_of(const Mesh& mesh, const mesh::CrossingSearch& search = {}) {
  const auto pairs = find_crossings(mesh, search).pairs;
  return {pairs.begin(), pairs.end()};
}

Mesh soup_of(const std::vector<std::array<Vec3, 3>>& triangles) {
  Mesh mesh;
  for (const auto& t : triangles) {
    const int first = static_cast<int>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), t.begin(), t.end());
    mesh.faces.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

const std::array<Vec3, 3> kFlat{Vec3(0, 0, 0), Vec3(4, 0, 0), Vec3(0, 4, 0)};

TEST(Crossings, of_two_triangles_apart) {
  const auto with = [](const Vec3& a, const Vec3& b, const Vec3& c) {
    return crossings_of(soup_of({kFlat, {a, b, c}}));
  };
  const Pairs one{{0, 1}};
  EXPECT_EQ(with({1, 1, -1}, {1, 1, 1}, {2, 2, 1}), one);         // The face pierces.
  EXPECT_EQ(with({1, 1, 1e-9}, {1, 1, 1}, {2, 2, 1}), Pairs{});   // The face is just above.
  EXPECT_EQ(with({1, 1, 0}, {1, 1, 1}, {2, 2, 1}), one);          // The face has a corner on the other one.
  EXPECT_EQ(with({4, 0, 0}, {5, 0, 1}, {5, 1, 1}), one);          // It touches a corner that is not its own.
  EXPECT_EQ(with({2, 2, 0}, {3, 3, 0}, {4, 2, 0}), one);          // It lies in the plane, with a corner on a side.
  EXPECT_EQ(with({2.5, 2, 0}, {3, 3, 0}, {4, 2, 0}), Pairs{});    // It lies in the plane, beside the face.
  EXPECT_EQ(with({0.5, 0.5, 0}, {1, 0.5, 0}, {0.5, 1, 0}), one);  // It lies in the plane, inside the face.
  EXPECT_EQ(with({5, -1, -1}, {5, 5, 1}, {6, 2, 0}), Pairs{});    // It passes through the plane, beside the face.
}

// Corner 0 is common; 1, 2 belong to the first, 3, 4 to the second.
TEST(Crossings, of_two_triangles_at_a_corner) {
  const auto with = [](const Vec3& c, const Vec3& d) {
    return crossings_of({{kFlat[0], kFlat[1], kFlat[2], c, d}, {{0, 1, 2}, {0, 3, 4}}});
  };
  const Pairs one{{0, 1}};
  EXPECT_EQ(with({-4, 0, 0}, {0, -4, 0}), Pairs{});
  EXPECT_EQ(with({-4, 4, 0}, {-4, 0, 0}), Pairs{});
  EXPECT_EQ(with({1, 1, 0}, {-1, 5, 0}), one);     // A side within the plane crosses the face.
  EXPECT_EQ(with({1, 1, -1}, {1, 1, 1}), one);     // It passes through the face.
  EXPECT_EQ(with({1, 1, 1}, {2, 1, 3}), Pairs{});  // The face is above.
  EXPECT_EQ(with({2, 0, 0}, {2, 0, -3}), one);     // A side lies on a side.
  EXPECT_EQ(with({8, 0, 0}, {8, 0, -3}), one);
}

// The edge 0 → 1 is common.
TEST(Crossings, of_two_triangles_at_an_edge) {
  const auto with = [](const Vec3& d) {
    return crossings_of({{kFlat[0], kFlat[1], kFlat[2], d}, {{0, 1, 2}, {1, 0, 3}}});
  };
  EXPECT_EQ(with({0, -4, 0}), Pairs{});
  EXPECT_EQ(with({0, 0, 4}), Pairs{});
  EXPECT_EQ(with({1, 3, 1e-12}), Pairs{});      // The faces are nearly folded back.
  EXPECT_EQ(with({1, 3, 0}), (Pairs{{0, 1}}));  // The faces are folded back.
  EXPECT_EQ(with(kFlat[2]), (Pairs{{0, 1}}));   // The face is folded onto itself.
}

TEST(Crossings, name_a_face_without_area_itself) {
  EXPECT_EQ(crossings_of(soup_of({{Vec3(0, 0, 0), Vec3(1, 1, 1), Vec3(3, 3, 3)}})), (Pairs{{0, 0}}));
  EXPECT_EQ(crossings_of(soup_of({{Vec3(0, 0, 0), Vec3(1, 1, 1), Vec3(3, 3, 3.0000001)}})), Pairs{});
}

Pairs crossings_by_cgal(const Mesh& mesh) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  CGAL::Surface_mesh<Kernel::Point_3> m;
  std::vector<CGAL::Surface_mesh<Kernel::Point_3>::Vertex_index> v;
  for (const Vec3& p : mesh.vertices) v.push_back(m.add_vertex({p.x(), p.y(), p.z()}));
  std::vector<int> number;
  for (std::size_t f = 0; f < mesh.faces.size(); ++f) {
    const auto corner = [&](std::size_t k) { return v[static_cast<std::size_t>(mesh.faces[f][k])]; };
    if (m.add_face(corner(0), corner(1), corner(2)).is_valid()) number.push_back(static_cast<int>(f));
  }
  EXPECT_EQ(number.size(), mesh.faces.size());
  std::vector<std::pair<CGAL::SM_Face_index, CGAL::SM_Face_index>> found;
  CGAL::Polygon_mesh_processing::self_intersections(m, std::back_inserter(found));
  Pairs pairs;
  for (const auto& [a, b] : found) pairs.push_back(std::minmax({number[a], number[b]}));
  std::ranges::sort(pairs);
  return pairs;
}

// Ten shapes with each kind of damage give 180 meshes of 500 to 1,100 faces, some with thousands of crossings.
TEST(Crossings, are_those_that_cgal_finds) {
  std::size_t total = 0;
  for (const auto& damage : test::damages()) {
    std::uint64_t seed = 40;
    for (const auto& shape : test::base_shapes()) {
      test::Dice dice(++seed);
      Mesh mesh = test::read_back(test::grid_of(shape.place, 20, 14));
      damage.make(mesh, dice);
      try {
        mesh::ExtractReport unused;
        mesh = mesh::joined(test::read_back(mesh), unused);
      } catch (const InputError&) {
        continue;  // The mesh is shattered.
      }
      const Pairs wanted = crossings_by_cgal(mesh);
      total += wanted.size();
      EXPECT_EQ(crossings_of(mesh, {.threads = 2}), wanted) << damage.name << ' ' << shape.name;
      EXPECT_EQ(find_crossings(mesh, {.any_one = true}).pairs.empty(), wanted.empty());
    }
  }
  EXPECT_GT(total, 4000U);
}

// On a sheet of 320,000 faces the clock is read before each part of 32,768 leaves.
TEST(Crossings, say_how_many_faces_were_tested_before_time_was_over) {
  const Mesh sheet = test::grid_of([](double u, double v) { return Vec3(300 * u, 300 * v, 10 * u * v); }, 400, 400);
  int asked = 0;
  const auto part = find_crossings(sheet, {.is_late = [&] { return ++asked > 1; }});
  EXPECT_GT(part.tested, 32'768U);
  EXPECT_LE(part.tested, 4U * 32'768U);
  EXPECT_EQ(find_crossings(sheet, {}).tested, sheet.faces.size());
  EXPECT_EQ(find_crossings(sheet, {.is_late = [] { return true; }}).tested, 0U);
}

}  // namespace
}  // namespace triskin

// SPDX-License-Identifier: GPL-3.0-or-later
// Tests the visibility of faces within a given time: first fewer faces are measured, then fewer rays are sent.
#include <gtest/gtest.h>

#include "triskin/mesh/extract_steps.hpp"

namespace triskin::mesh {
namespace {

void add_box(Mesh& mesh, double half_mm) {
  const int first = static_cast<int>(mesh.vertices.size());
  for (int k = 0; k < 8; ++k)
    mesh.vertices.emplace_back((k & 1) != 0 ? half_mm : -half_mm, (k & 2) != 0 ? half_mm : -half_mm,
                               (k & 4) != 0 ? half_mm : -half_mm);
  for (const auto& [a, b, c] : std::vector<std::array<int, 3>>{{0, 2, 1},
                                                               {1, 2, 3},
                                                               {4, 5, 6},
                                                               {5, 7, 6},
                                                               {0, 1, 4},
                                                               {1, 5, 4},
                                                               {2, 6, 3},
                                                               {3, 6, 7},
                                                               {0, 4, 2},
                                                               {2, 4, 6},
                                                               {1, 3, 5},
                                                               {3, 7, 5}})
    mesh.faces.push_back({first + a, first + b, first + c});
}

TEST(Visibility, as_many_rays_are_sent_as_fit_but_at_least_eight) {
  for (const double cpu_s : {0.2, 1.0, 5.0}) {
    const std::size_t fitting = faces_asked_in(cpu_s);
    EXPECT_EQ(rays_for(1, cpu_s), 64);
    EXPECT_EQ(rays_for(fitting, cpu_s), 64);
    EXPECT_EQ(rays_for(2 * fitting, cpu_s), 32);
    EXPECT_EQ(rays_for(1000 * fitting, cpu_s), 8);
  }
}

TEST(Visibility, eight_rays_tell_a_box_from_the_one_inside_it) {
  Mesh mesh;
  add_box(mesh, 100.0);
  add_box(mesh, 50.0);
  std::vector<FaceIndex> faces(mesh.faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) faces[f] = FaceIndex(f);
  for (const int rays : {8, 64}) {
    const std::vector<Visibility> visibility = visibility_of(mesh, faces, rays);
    for (std::size_t f = 0; f < faces.size(); ++f) {
      EXPECT_EQ(visibility[f].front, f < 12 ? 1.0 : 0.0) << rays << " rays, face " << f;
      EXPECT_EQ(visibility[f].back, 0.0) << rays << " rays, face " << f;
    }
  }
}

// A wall hides half of the sky over a face; the answer of eight rays is within the share of one ray.
TEST(Visibility, fewer_rays_find_about_the_same_share) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, -1e6, -1}, {-1, 1e6, -1}, {-1, 0, 1e6}};
  mesh.faces = {{0, 1, 2}, {3, 4, 5}};
  const std::vector<FaceIndex> first{FaceIndex{0}};
  const double many = visibility_of(mesh, first, 64)[0].front, few = visibility_of(mesh, first, 8)[0].front;
  EXPECT_GT(many, 0.5);
  EXPECT_LT(many, 0.9);
  EXPECT_NEAR(few, many, 0.125);
}

}  // namespace
}  // namespace triskin::mesh

// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the search tree of a surface and the grid of the growth with a loop over all faces and border edges.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "plan/lattice/src/near_surface.hpp"
#include "shapes.hpp"
#include "triskin/geometry/triangle.hpp"

namespace triskin::lattice {
namespace {

constexpr int kQueries = 2000;
constexpr double kRounding_mm = 1e-9;

// Points lie near a saddle with border: in front of it, behind it and past its rim.
class ClosestPoint : public testing::Test {
 protected:
  Vec3 query() {
    std::uniform_real_distribution<double> side(-70.0, 70.0), height(-20.0, 20.0);
    const double x = side(random_), y = side(random_);
    return {x, y, 0.004 * (x * x - y * y) + height(random_)};
  }
  [[nodiscard]] double min_over_faces(const Vec3& q) const {
    double least = std::numeric_limits<double>::infinity();
    const Mesh& m = surface_.mesh();
    for (const auto& f : m.faces) {
      const Vec3 &a = m.vertices[at(f[0])], &b = m.vertices[at(f[1])], &c = m.vertices[at(f[2])];
      const Vec3 w = geometry::closest_on_triangle(q, a, b, c);
      least = std::min(least, (w[0] * a + w[1] * b + w[2] * c - q).norm());
    }
    return least;
  }
  [[nodiscard]] double min_over_border(const Vec3& q) const {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& loop : surface_.border_loops()) {
      for (std::size_t k = 0; k < loop.size(); ++k) {
        const Vec3& a = surface_.mesh().vertices[at(loop[k])];
        const Vec3& b = surface_.mesh().vertices[at(loop[(k + 1) % loop.size()])];
        const double t = std::clamp((q - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
        least = std::min(least, (a + t * (b - a) - q).norm());
      }
    }
    return least;
  }

  std::mt19937 random_{1};
  const mesh::Surface surface_{grid_mesh(17, 13, [](double u, double v) {
    const double x = 120.0 * (u - 0.5), y = 100.0 * (v - 0.5);
    return Vec3(x, y, 0.004 * (x * x - y * y));
  })};
};

TEST_F(ClosestPoint, of_the_tree_is_that_of_a_loop_over_all_faces) {
  for (int k = 0; k < kQueries; ++k) {
    const Vec3 q = query();
    const mesh::SurfacePoint p = surface_.closest(q);
    EXPECT_NEAR(p.distance_mm, min_over_faces(q), kRounding_mm);
    EXPECT_NEAR((p.position_mm - q).norm(), p.distance_mm, kRounding_mm);
  }
}

TEST_F(ClosestPoint, is_the_same_where_a_bound_of_it_is_known) {
  for (int k = 0; k < kQueries; ++k) {
    const Vec3 q = query();
    const mesh::SurfacePoint p = surface_.closest(q), border = surface_.closest_on_border(q);
    const double more = 1.0 + 1e-9;
    EXPECT_EQ(surface_.closest(q, more * p.distance_mm).position_mm, p.position_mm);
    EXPECT_EQ(surface_.closest_on_border(q, more * border.distance_mm).position_mm, border.position_mm);
    EXPECT_EQ(surface_.closest(q, 0.99 * p.distance_mm).face, -1);
    EXPECT_EQ(surface_.closest_on_border(q, 0.99 * border.distance_mm).face, -1);
  }
}

// Two triangles are folded back onto each other: the sum of the normals at common corners was 1e-16 of rounding,
// normalized to a unit vector of arbitrary direction. `check` had another one, and reported a turn of the normal that
// differed from the stated one.
TEST(FoldedFlap, has_no_normal_at_its_fold_and_that_of_the_face_counts) {
  const Vec3 a(1.1, 2.3, 0.7), b(31.7, 5.9, 3.1), c(7.3, 33.3, 9.7);
  const Vec3 over = b + 0.73 * (a - b);
  const mesh::Surface surface(Mesh{{a, b, c, over}, {{0, 1, 2}, {2, 1, 3}}});
  const FaceIndex first{0};
  ASSERT_NEAR(surface.face_normal(first).dot(surface.face_normal(FaceIndex{1})), -1.0, 1e-12);
  EXPECT_EQ(surface.vertex_normal(VertexIndex{1}), Vec3(Vec3::Zero()));
  const mesh::SurfacePoint corner{b, first, {0.0, 1.0, 0.0}, 0.0};
  EXPECT_EQ(surface.normal_at(corner), surface.face_normal(first));
}

TEST_F(ClosestPoint, of_the_border_is_that_of_a_loop_over_all_its_edges) {
  for (int k = 0; k < kQueries; ++k) {
    const Vec3 q = query();
    EXPECT_NEAR(surface_.closest_on_border(q).distance_mm, min_over_border(q), kRounding_mm);
    EXPECT_NEAR(surface_.border_distance(q), min_over_border(q), kRounding_mm);
  }
}

TEST_F(ClosestPoint, of_the_grid_is_that_of_the_tree) {
  lattice::NearSurface grid(surface_);
  int from_cells = 0;
  for (int k = 0; k < kQueries; ++k) {
    const Vec3 q = query();
    const mesh::SurfacePoint p = surface_.closest(q);
    const lattice::Foot foot = grid.closest(q);
    EXPECT_NEAR(foot.distance_mm, p.distance_mm, kRounding_mm);
    EXPECT_NEAR((foot.point - p.position_mm).norm(), 0.0, kRounding_mm);
    EXPECT_NEAR((foot.normal - surface_.normal_at(p)).norm(), 0.0, kRounding_mm);
    EXPECT_LE(grid.border_at_least(q), min_over_border(q) + kRounding_mm);
    EXPECT_TRUE(!foot.on_border || grid.may_be_over_border(q));
    if (p.distance_mm < 6.0) ++from_cells;
  }
  EXPECT_GT(from_cells, kQueries / 10) << "few queries were near enough for the cells to answer them";
}

}  // namespace
}  // namespace triskin::lattice

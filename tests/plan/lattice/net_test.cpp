// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the net of the growth with loops over all of it: random nets in a plane are grown, ruined, separated and
// rolled back; the values that it updates by changes must equal a count from nothing.
#include "plan/lattice/src/net.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "plan/lattice/src/net_price.hpp"
#include "random_net.hpp"

namespace triskin::lattice {
namespace {

constexpr int kSteps = 80;
constexpr Price kPrice{.controller = 2.0, .jumper = 0.25, .island = 0.1};
constexpr double kJumper_mm = 15.0;

using TriangleState = std::tuple<int, std::array<int, 3>, Tile, std::array<Vec3, 3>>;
std::map<int, TriangleState> triangles_of(const LatticeMesh& net) {
  std::map<int, TriangleState> state;
  for (const int t : used_triangles(net)) {
    const NetTriangle& triangle = net.triangles()[at(t)];
    state[t] = {triangle.island, triangle.vertex, triangle.tile, triangle.rigid};
  }
  return state;
}
using VertexState = std::tuple<Vec3, int, int, std::set<int>>;
std::map<int, VertexState> vertices_of(const LatticeMesh& net) {
  std::map<int, VertexState> state;
  for (int v = 0; v < static_cast<int>(net.vertices().size()); ++v) {
    const NetVertex& w = net.vertices()[at(v)];
    if (w.used) state[v] = {w.point, w.i, w.j, {w.triangles.begin(), w.triangles.begin() + w.valence}};
  }
  return state;
}

class Net : public testing::TestWithParam<unsigned> {};

TEST_P(Net, says_of_itself_what_a_count_gives_and_takes_back_every_step) {
  RandomNet random(GetParam());
  NetPrice price(kPrice, kJumper_mm);
  for (int k = 0; k < 6; ++k) random.seed();
  random.net.separate();
  int taken_back = 0, max_islands = 0;
  for (int k = 0; k < kSteps; ++k) {
    const LatticeMesh before = random.net;
    random.net.begin();
    random.step();
    ASSERT_NO_FATAL_FAILURE(expect_right(random.net, random.place())) << "step " << k;
    LatticeMesh copy = random.net;
    const EstimatedPrice followed = price(random.net), counted = NetPrice(kPrice, kJumper_mm)(copy);
    EXPECT_EQ(followed.relaxed.controllers, counted.relaxed.controllers) << "step " << k;
    EXPECT_EQ(followed.relaxed.joining, counted.relaxed.joining) << "step " << k;
    EXPECT_EQ(followed.rounded, counted.rounded) << "step " << k;
    max_islands = std::max(max_islands, random.net.islands());
    if (random.random.below(2) == 0) {
      random.net.commit();
      continue;
    }
    ++taken_back;
    const Vec3 place = random.place();
    random.net.roll_back();
    ASSERT_EQ(triangles_of(random.net), triangles_of(before)) << "step " << k;
    ASSERT_EQ(vertices_of(random.net), vertices_of(before)) << "step " << k;
    EXPECT_EQ(random.net.signature(place, 60.0), before.signature(place, 60.0));
    ASSERT_NO_FATAL_FAILURE(expect_right(random.net, place)) << "step " << k;
  }
  EXPECT_GT(taken_back, kSteps / 3);
  EXPECT_GT(max_islands, 8);
}
INSTANTIATE_TEST_SUITE_P(Random, Net, testing::Values(1U, 2U, 3U));

TEST(PointGrid, finds_points_inside_and_outside_its_box) {
  Dice random(7);
  PointGrid grid({Vec3(0, 0, 0), Vec3(200, 100, 50)}, 20.0);
  std::vector<Vec3> points;
  for (int k = 0; k < 400; ++k) {
    points.emplace_back(400 * random.unit() - 100, 300 * random.unit() - 100, 250 * random.unit() - 100);
    grid.add(k, points.back());
  }
  for (int k = 0; k < 400; k += 3) {
    points[at(k)] += Vec3(50, -30, 20);
    grid.move(k, points[at(k)]);
  }
  for (int query = 0; query < 200; ++query) {
    const Vec3 place(400 * random.unit() - 100, 300 * random.unit() - 100, 250 * random.unit() - 100);
    const double radius = 80.0 * random.unit();
    std::set<int> found, expected;
    EXPECT_FALSE(grid.any_near(place, radius, [&](int k) {
      if ((points[at(k)] - place).norm() < radius) found.insert(k);
      return false;
    }));
    for (int k = 0; k < 400; ++k) {
      if ((points[at(k)] - place).norm() < radius) expected.insert(k);
    }
    EXPECT_EQ(found, expected);
  }
}

}  // namespace
}  // namespace triskin::lattice

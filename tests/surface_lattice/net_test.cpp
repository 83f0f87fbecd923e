// SPDX-License-Identifier: GPL-3.0-or-later
// The net of the growth against loops over all of it: random nets in a plane are grown, ruined, parted and taken back;
// what it keeps up to date by changes must be what a count from nothing gives.
#include "../../host/geometry/src/surface_lattice/net.hpp"  // no public header

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "../../host/geometry/src/surface_lattice/net_price.hpp"
#include "nets.hpp"
#include "triskin/host/dice.hpp"

namespace triskin::geometry::surface_lattice {
namespace {

constexpr double kSheet_mm = 400.0;
constexpr int kSteps = 80;
constexpr Price kPrice{.controller = 2.0, .jumper = 0.25, .island = 0.1};
constexpr double kJumper_mm = 15.0;

struct RandomNet {
  explicit RandomNet(std::uint64_t seed) : random(seed), net({Vec3(0, 0, 0), Vec3(kSheet_mm, kSheet_mm, 0)}, 0.0) {}

  [[nodiscard]] Vec3 place() { return {kSheet_mm * random.unit(), kSheet_mm * random.unit(), 0.0}; }

  void seed() { add_island(net, place()); }

  // A tile at an open side; one time in four it does not join a vertex that is there, which leaves a slit.
  void extend() {
    const int t = random.below(static_cast<int>(net.triangles().size())), side = random.below(3);
    if (!net.used(t) || net.neighbour(t, side) >= 0) return;
    const NetTriangle triangle = net.triangles()[at(t)];
    const TileSide next = across(triangle.tile, side);
    if (net.has_tile(triangle.island, next.tile)) return;
    const int a = triangle.vertex[at(side)], b = triangle.vertex[at((side + 1) % 3)];
    const auto label = tile_corner_index(next.tile, (next.side + 2) % 3);
    const Vec3 apex = net.vertices()[at(a)].point + net.vertices()[at(b)].point -
                      net.vertices()[at(triangle.vertex[at((side + 2) % 3)])].point;
    int third = -1;
    for (int v = 0; v < static_cast<int>(net.vertices().size()) && random.below(4) > 0; ++v) {
      const NetVertex& w = net.vertices()[at(v)];
      if (w.used && w.i == label[0] && w.j == label[1] && w.valence < 6 && (w.point - apex).norm() < 1.0 &&
          net.triangles()[at(w.triangles[0])].island == triangle.island && v != a && v != b)
        third = v;
    }
    if (third < 0) third = net.add_vertex(apex, Vec3::UnitZ(), label[0], label[1]);
    std::array<int, 3> v{};
    v[at(next.side)] = b;
    v[at((next.side + 1) % 3)] = a;
    v[at((next.side + 2) % 3)] = third;
    const int added = net.add_triangle(triangle.island, next.tile, v);
    if (random.below(5) == 0) net.take_back(added);
  }

  void ruin() {
    std::vector<int> inside;
    net.near(place(), 20.0 + 50.0 * random.unit(), inside);
    for (const int t : inside) net.remove_triangle(t);
  }

  void move() {
    std::vector<int> inside;
    net.near(place(), 40.0, inside);
    for (const int t : inside)
      net.edit_vertex(net.triangles()[at(t)].vertex[0]).point += Vec3(random.unit() - 0.5, 0, 0);
    for (int t = 0; t < static_cast<int>(net.triangles().size()); ++t) {
      if (net.used(t)) net.fit(t);
    }
  }

  void step() {
    ruin();
    net.separate();
    if (random.below(3) == 0) seed();
    for (int k = 0; k < 60; ++k) extend();
    if (random.below(3) == 0) move();
    net.separate();
  }

  Dice random;
  LatticeNet net;
};

int shared_vertices(const NetTriangle& a, const NetTriangle& b) {
  return static_cast<int>(
      std::ranges::count_if(a.vertex, [&](int v) { return std::ranges::find(b.vertex, v) != b.vertex.end(); }));
}

std::vector<int> used_triangles(const LatticeNet& net) {
  std::vector<int> used;
  for (int t = 0; t < static_cast<int>(net.triangles().size()); ++t) {
    if (net.used(t)) used.push_back(t);
  }
  return used;
}

// Everything that the net says about itself, counted from its triangles.
void expect_right(const LatticeNet& net, const Vec3& place) {
  const std::vector<int> used = used_triangles(net);
  ASSERT_EQ(net.size(), static_cast<int>(used.size()));
  int joints = 0;
  std::map<int, std::set<int>> joined;
  for (const int a : used) {
    for (const int b : used) {
      if (a >= b || shared_vertices(net.triangles()[at(a)], net.triangles()[at(b)]) < 2) continue;
      ++joints;
      joined[a].insert(b);
      joined[b].insert(a);
    }
  }
  EXPECT_EQ(net.joints(), joints);
  std::map<int, int> sizes;
  std::set<int> seen, numbers;
  for (const int first : used) {
    if (seen.contains(first)) continue;
    std::vector<int> island{first};
    seen.insert(first);
    for (std::size_t k = 0; k < island.size(); ++k) {
      for (const int n : joined[island[k]]) {
        if (seen.insert(n).second) island.push_back(n);
      }
    }
    const int number = net.triangles()[at(first)].island;
    EXPECT_TRUE(numbers.insert(number).second) << "two islands with one number";
    for (const int t : island) EXPECT_EQ(net.triangles()[at(t)].island, number);
    sizes[number] = static_cast<int>(island.size());
  }
  EXPECT_EQ(net.islands(), static_cast<int>(sizes.size()));
  for (int k = 0; k < static_cast<int>(net.island_sizes().size()); ++k)
    EXPECT_EQ(net.island_sizes()[at(k)], sizes.contains(k) ? sizes[k] : 0);
  for (const int t : used) {
    const NetTriangle& triangle = net.triangles()[at(t)];
    EXPECT_TRUE(net.has_tile(triangle.island, triangle.tile));
    const TileSide beside = across(triangle.tile, 0);
    EXPECT_EQ(net.has_tile(triangle.island, beside.tile), std::ranges::any_of(used, [&](int other) {
                const NetTriangle& o = net.triangles()[at(other)];
                return o.island == triangle.island && o.tile == beside.tile;
              }));
    for (const int v : triangle.vertex) {  // the triangles of a vertex are one fan
      const NetVertex& w = net.vertices()[at(v)];
      std::set<int> round(w.triangles.begin(), w.triangles.begin() + w.valence), fan{t};
      EXPECT_TRUE(w.used && round.contains(t));
      for (std::size_t grown = 0; grown != fan.size();) {
        grown = fan.size();
        for (const int o : round) {
          if (std::ranges::any_of(joined[o], [&](int n) { return fan.contains(n); })) fan.insert(o);
        }
      }
      EXPECT_EQ(fan, round);
    }
  }
  std::vector<int> near, expected;
  net.near(place, 70.0, near);
  std::ranges::copy_if(used, std::back_inserter(expected),
                       [&](int t) { return (net.triangles()[at(t)].center - place).norm() < 70.0; });
  EXPECT_EQ(near, expected);
}

using TriangleState = std::tuple<int, std::array<int, 3>, Tile, std::array<Vec3, 3>>;
std::map<int, TriangleState> triangles_of(const LatticeNet& net) {
  std::map<int, TriangleState> state;
  for (const int t : used_triangles(net)) {
    const NetTriangle& triangle = net.triangles()[at(t)];
    state[t] = {triangle.island, triangle.vertex, triangle.tile, triangle.rigid};
  }
  return state;
}
using VertexState = std::tuple<Vec3, int, int, std::set<int>>;
std::map<int, VertexState> vertices_of(const LatticeNet& net) {
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
  int taken_back = 0, most_islands = 0;
  for (int k = 0; k < kSteps; ++k) {
    const LatticeNet before = random.net;
    random.net.begin();
    random.step();
    ASSERT_NO_FATAL_FAILURE(expect_right(random.net, random.place())) << "step " << k;
    LatticeNet copy = random.net;
    const EstimatedPrice followed = price(random.net), counted = NetPrice(kPrice, kJumper_mm)(copy);
    EXPECT_EQ(followed.relaxed, counted.relaxed) << "step " << k;
    EXPECT_EQ(followed.rounded, counted.rounded) << "step " << k;
    most_islands = std::max(most_islands, random.net.islands());
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
  EXPECT_GT(most_islands, 8);
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
}  // namespace triskin::geometry::surface_lattice

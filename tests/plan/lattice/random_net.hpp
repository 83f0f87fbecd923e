// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include "nets.hpp"
#include "plan/lattice/src/zones.hpp"
#include "triskin/base/dice.hpp"

namespace triskin::lattice {

inline constexpr double kSheet_mm = 400.0;

// Grows and ruins a net at random in a plane: all of it, or only the part in a zone.
struct RandomNet {
  explicit RandomNet(std::uint64_t seed) : random(seed), net({Vec3(0, 0, 0), Vec3(kSheet_mm, kSheet_mm, 0)}, 0.0) {}

  [[nodiscard]] Vec3 place() { return {kSheet_mm * random.unit(), kSheet_mm * random.unit(), 0.0}; }

  void seed() {
    const Vec3 origin = place();
    if (zone.holds(origin + Vec3(15.0, kHeight_mm / 3.0, 0.0))) add_island(net, origin);
  }

  // Adds a tile at an open side; one time in four it does not join an existing vertex, which leaves a slit.
  void extend() {
    const int t = random.below(static_cast<int>(net.triangles().size())), side = random.below(3);
    if (!net.used(t) || net.neighbour(t, side) >= 0) return;
    const NetTriangle triangle = net.triangles()[at(t)];
    const TileSide next = across(triangle.tile, side);
    if (net.has_tile(triangle.island, next.tile)) return;
    const int a = triangle.vertex[at(side)], b = triangle.vertex[at((side + 1) % 3)];
    const auto label = tile_corner_index(next.tile, (next.side + 2) % 3);
    if (!zone.holds(triangle.rigid[at(side)] + triangle.rigid[at((side + 1) % 3)] - triangle.center)) return;
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
    for (const int t : inside) {
      if (!net.triangles()[at(t)].is_fixed) net.remove_triangle(t);
    }
  }

  void move() {
    std::vector<int> inside;
    net.near(place(), 40.0, inside);
    for (const int t : inside) {
      const int v = net.triangles()[at(t)].vertex[0];
      if (!net.vertices()[at(v)].is_fixed) net.edit_vertex(v).point += Vec3(random.unit() - 0.5, 0, 0);
    }
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
  LatticeMesh net;
  Zone zone;
};

inline int shared_vertices(const NetTriangle& a, const NetTriangle& b) {
  return static_cast<int>(
      std::ranges::count_if(a.vertex, [&](int v) { return std::ranges::find(b.vertex, v) != b.vertex.end(); }));
}

inline std::vector<int> used_triangles(const LatticeMesh& net) {
  std::vector<int> used;
  for (int t = 0; t < static_cast<int>(net.triangles().size()); ++t) {
    if (net.used(t)) used.push_back(t);
  }
  return used;
}

// Compares all that the net states about itself with counts over its triangles.
inline void expect_right(const LatticeMesh& net, const Vec3& place) {
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
    for (const int v : triangle.vertex) {  // The triangles of a vertex are one fan.
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

}  // namespace triskin::lattice

// SPDX-License-Identifier: GPL-3.0-or-later
// Tests which layouts the growth keeps beside the best one, and that they stay few on large parts.
#include "plan/lattice/src/layout_front.hpp"

#include <gtest/gtest.h>

#include "nets.hpp"
#include "triskin/base/dice.hpp"

namespace triskin::lattice {
namespace {

// Makes a net of islands of one module each.
NetCopy net_of(int modules) {
  auto net = std::make_shared<LatticeMesh>(std::vector{Vec3(0, 0, 0), Vec3(50.0 * modules, 50.0, 0)}, 0.0);
  for (int m = 0; m < modules; ++m) add_island(*net, Vec3(50.0 * m, 0, 0));
  return net;
}

std::vector<std::pair<int, double>> kept(const LayoutFront& front) {
  std::vector<std::pair<int, double>> all;
  for (const auto& [numbers, found] : front.found()) all.emplace_back(numbers.first, found.value);
  return all;
}

TEST(LayoutFront, keeps_the_best_of_each_number_and_the_most_valuable_where_they_are_too_many) {
  LayoutFront front(10);
  front.keep(net_of(3), 2.0);
  front.keep(net_of(3), 1.5);  // The value is less than the present one.
  front.keep(net_of(4), 3.0);
  EXPECT_EQ(kept(front), (std::vector<std::pair<int, double>>{{3, 2.0}, {4, 3.0}}));
  EXPECT_FALSE(front.would_keep(*net_of(5), 1.9));  // There are 12 modules, and the others are worth more.
  front.keep(net_of(5), 2.5);
  EXPECT_EQ(kept(front), (std::vector<std::pair<int, double>>{{4, 3.0}, {5, 2.5}}));
  front.forget_below(5);
  EXPECT_EQ(kept(front), (std::vector<std::pair<int, double>>{{5, 2.5}}));
  front.keep(net_of(5), 2.75);  // It replaces the layout with the same numbers, so there are still five modules.
  front.keep(net_of(1), 0.5);
  EXPECT_EQ(kept(front), (std::vector<std::pair<int, double>>{{1, 0.5}, {5, 2.75}}));
}

TEST(LayoutFront, keeps_one_layout_however_large) {
  LayoutFront front(10);
  front.keep(net_of(20), 15.0);
  EXPECT_EQ(kept(front), (std::vector<std::pair<int, double>>{{20, 15.0}}));
  front.keep(net_of(21), 15.5);
  EXPECT_EQ(kept(front), (std::vector<std::pair<int, double>>{{21, 15.5}}));
}

// Ten thousand layouts of a part with a thousand modules once took gigabytes.
TEST(LayoutFront, holds_no_more_modules_than_it_may) {
  LayoutFront front(500);
  Dice random(3);
  for (int k = 0; k < 2000; ++k) {
    front.keep(net_of(20 + random.below(40)), 60.0 * random.unit());
    int modules = 0;
    for (const auto& [numbers, found] : front.found()) modules += found.net->size();
    ASSERT_LE(modules, 500) << k;
  }
  EXPECT_GE(front.found().size(), 8U);
}

// There are islands of 1, 1, 1, 2 and 3 modules, and one of the single ones is fixed.
TEST(Thinned, leaves_out_the_smallest_islands_until_few_enough_are_left) {
  LatticeMesh net({Vec3(0, 0, 0), Vec3(600, 60, 0)}, 0.0);
  const int fixed = add_island(net, Vec3(0, 0, 0));
  net.pin(fixed, net.triangles()[at(fixed)].rigid);
  add_island(net, Vec3(100, 0, 0));
  add_island(net, Vec3(200, 0, 0));
  for (const auto& [x, more] : {std::pair(300.0, 1), std::pair(400.0, 2)}) {
    const int first = add_island(net, Vec3(x, 0, 0));
    for (int side = 1; side <= more; ++side) {
      const NetTriangle t = net.triangles()[at(first)];
      const TileSide next = across(t.tile, side);
      std::array<int, 3> v{};
      v[at(next.side)] = t.vertex[at((side + 1) % 3)];
      v[at((next.side + 1) % 3)] = t.vertex[at(side)];
      v[at((next.side + 2) % 3)] = net.add_vertex(t.center + Vec3(30, 30.0 * side, 0), Vec3::UnitZ(), 5, side);
      net.add_triangle(t.island, next.tile, v);
    }
  }
  net.separate();
  ASSERT_EQ(net.size(), 8);
  const auto sizes = [&](int modules, std::size_t layouts) {
    std::vector<std::pair<int, int>> all;
    for (const LatticeMesh& less : thinned(net, modules, layouts)) {
      EXPECT_TRUE(less.used(fixed));
      all.emplace_back(less.size(), less.islands());
    }
    return all;
  };
  using Sizes = std::vector<std::pair<int, int>>;
  EXPECT_EQ(sizes(8, 5), Sizes{});
  EXPECT_EQ(sizes(7, 5), (Sizes{{7, 4}}));
  EXPECT_EQ(sizes(5, 5), (Sizes{{4, 2}, {6, 3}, {7, 4}}));
  EXPECT_EQ(sizes(5, 2), (Sizes{{4, 2}, {7, 4}}));  // Every second layout is taken.
  EXPECT_EQ(sizes(0, 1), (Sizes{{1, 1}}));          // The fixed module stays.
}

}  // namespace
}  // namespace triskin::lattice

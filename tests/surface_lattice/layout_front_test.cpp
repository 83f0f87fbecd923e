// SPDX-License-Identifier: GPL-3.0-or-later
// What the growth keeps beside the best layout, and that it stays small on large parts.
#include "../../host/geometry/src/surface_lattice/layout_front.hpp"  // no public header

#include <gtest/gtest.h>

#include "nets.hpp"
#include "triskin/host/dice.hpp"

namespace triskin::geometry::surface_lattice {
namespace {

// A net of islands of one module each.
NetCopy net_of(int modules) {
  auto net = std::make_shared<LatticeNet>(std::vector{Vec3(0, 0, 0), Vec3(50.0 * modules, 50.0, 0)}, 0.0);
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
  front.keep(net_of(3), 1.5);  // less than what is there
  front.keep(net_of(4), 3.0);
  EXPECT_EQ(kept(front), (std::vector<std::pair<int, double>>{{3, 2.0}, {4, 3.0}}));
  EXPECT_FALSE(front.would_keep(*net_of(5), 1.9));  // 12 modules, and the others are worth more
  front.keep(net_of(5), 2.5);
  EXPECT_EQ(kept(front), (std::vector<std::pair<int, double>>{{4, 3.0}, {5, 2.5}}));
  front.forget_below(5);
  EXPECT_EQ(kept(front), (std::vector<std::pair<int, double>>{{5, 2.5}}));
  front.keep(net_of(5), 2.75);  // in the place of its like: still five modules
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

}  // namespace
}  // namespace triskin::geometry::surface_lattice

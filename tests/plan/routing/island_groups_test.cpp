// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the bound by groups of islands with a search over all divisions of the islands into groups.
#include "plan/routing/src/island_groups.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <random>

namespace triskin::routing {
namespace {

constexpr int kCapacity = 16;
constexpr long kAmple = 1'000'000'000;

// Makes a ring or a random tree, and some more neighbours; islands that are one patch, several, and some that need more
// patches alone than their weight says.
IslandGraph random_graph(std::mt19937_64& random) {
  IslandGraph g;
  const int n = 2 + static_cast<int>(random() % 6);
  const bool ring = random() % 2 == 0;
  g.neighbour.assign(static_cast<std::size_t>(n), 0);
  const auto join = [&](int a, int b) {
    if (a == b) return;
    g.neighbour[static_cast<std::size_t>(a)] |= IslandSet{1} << b;
    g.neighbour[static_cast<std::size_t>(b)] |= IslandSet{1} << a;
  };
  for (int k = 0; k < n; ++k) {
    g.weight.push_back(1 + static_cast<int>(random() % (random() % 3 == 0 ? 40 : 12)));
    g.alone.push_back((g.weight.back() + kCapacity - 1) / kCapacity + (random() % 5 == 0 ? 1 : 0));
    if (k > 0) join(k, ring ? k - 1 : static_cast<int>(random() % static_cast<unsigned>(k)));
  }
  if (ring) join(0, n - 1);
  for (std::uint64_t more = random() % 3; more > 0; --more)
    join(static_cast<int>(random() % static_cast<unsigned>(n)), static_cast<int>(random() % static_cast<unsigned>(n)));
  return g;
}

bool hang_together(const IslandGraph& g, IslandSet group) {
  IslandSet seen = group & (~group + 1);
  for (IslandSet before = 0; before != seen;) {
    before = seen;
    for (IslandSet rest = before; rest != 0; rest &= rest - 1)
      seen |= g.neighbour[static_cast<std::size_t>(std::countr_zero(rest))] & group;
  }
  return seen == group;
}

// Returns the price by definition: an island alone has its stated parts, groups have their weight and one jumper less
// than islands.
std::int64_t price_by_hand(const IslandGraph& g, IslandSet group, const IntegerPrice& price) {
  if (std::has_single_bit(group)) return price.part * g.alone[static_cast<std::size_t>(std::countr_zero(group))];
  int weight = 0;
  for (IslandSet rest = group; rest != 0; rest &= rest - 1)
    weight += g.weight[static_cast<std::size_t>(std::countr_zero(rest))];
  return price.part * ((weight + kCapacity - 1) / kCapacity) + price.jumper * (std::popcount(group) - 1);
}

std::int64_t by_trying_everything(const IslandGraph& g, const IntegerPrice& price, const IslandGroups::Known& known) {
  const IslandSet all = (IslandSet{1} << g.weight.size()) - 1;
  std::vector<std::int64_t> best(all + 1, std::int64_t{1} << 60);
  best[0] = 0;
  for (IslandSet rest = 1; rest <= all; ++rest) {
    for (IslandSet group = rest; group != 0; group = (group - 1) & rest) {
      if (!hang_together(g, group)) continue;
      const auto found = known.find(group);
      const std::int64_t with = found != known.end() ? found->second : price_by_hand(g, group, price);
      best[rest] = std::min(best[rest], with + best[rest & ~group]);
    }
  }
  return best[all];
}

TEST(IslandGroups, the_least_price_is_that_of_trying_everything) {
  std::mt19937_64 random(31);
  const std::array<design::Price, 3> prices{{{2.0, 0.45, 0.1}, {1.0, 0.75, 0.0}, {3.0, 0.1, 0.0}}};
  for (int trial = 0; trial < 1500; ++trial) {
    const IslandGraph g = random_graph(random);
    const IntegerPrice price(prices[static_cast<std::size_t>(trial % 3)]);
    const std::int64_t least = by_trying_everything(g, price, {});
    // The limits leave out nothing, or the cheapest is just inside, or just outside.
    EXPECT_EQ(IslandGroups(g, kCapacity, price, std::int64_t{1} << 60, kAmple).least(), least) << trial;
    EXPECT_EQ(IslandGroups(g, kCapacity, price, least + 1, kAmple).least(), least) << trial;
    EXPECT_EQ(IslandGroups(g, kCapacity, price, least, kAmple).least(), least) << trial;
  }
}

// The known price of some groups rises, as it does when they are settled one by one.
TEST(IslandGroups, what_is_known_of_groups_counts) {
  std::mt19937_64 random(32);
  const IntegerPrice price(design::Price{2.0, 0.45, 0.1});
  int raised = 0;
  for (int trial = 0; trial < 600; ++trial) {
    const IslandGraph g = random_graph(random);
    const std::int64_t limit = by_trying_everything(g, price, {}) + price.jumper * static_cast<int>(1 + random() % 4);
    const IslandGroups groups(g, kCapacity, price, limit, kAmple);
    IslandGroups::Known known;
    for (int round = 0; round < 12; ++round) {
      const std::int64_t least = by_trying_everything(g, price, known);
      long budget = kAmple;
      const auto division = groups.cheapest(known, limit, budget);
      ASSERT_TRUE(division.has_value()) << trial;
      ASSERT_EQ(division->groups.empty(), least >= limit) << trial << ' ' << round;
      if (least >= limit) break;
      ASSERT_EQ(division->price, least) << trial << ' ' << round;
      std::int64_t sum = 0;
      IslandSet all = 0;
      for (const IslandSet group : division->groups) {
        sum += known.contains(group) ? known.at(group) : groups.price_of(group);
        EXPECT_EQ(all & group, 0U) << trial;
        all |= group;
      }
      EXPECT_EQ(sum, least) << trial;
      EXPECT_EQ(all, (IslandSet{1} << g.weight.size()) - 1) << trial;
      const IslandSet group = division->groups[random() % division->groups.size()];
      known[group] = (known.contains(group) ? known.at(group) : groups.price_of(group)) + price.jumper;
      ++raised;
    }
  }
  EXPECT_GT(raised, 1000);
}

TEST(IslandGroups, a_budget_that_ends_says_nothing) {
  std::mt19937_64 random(33);
  const IntegerPrice price(design::Price{2.0, 0.45, 0.1});
  const IslandGroups groups(random_graph(random), kCapacity, price, std::int64_t{1} << 60, 1);
  EXPECT_FALSE(groups.least().has_value());
  long budget = kAmple;
  EXPECT_FALSE(groups.cheapest({}, std::int64_t{1} << 60, budget).has_value());
}

}  // namespace
}  // namespace triskin::routing

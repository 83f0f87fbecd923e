// SPDX-License-Identifier: GPL-3.0-or-later
// Compares the lowest price of controllers and jumpers with a search over all partitions.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <random>

#include "plan/routing/src/jumper_frontier.hpp"
#include "triskin/base/error.hpp"
#include "triskin/design/tile.hpp"
#include "triskin/routing/routing.hpp"

namespace triskin::routing {
namespace {

struct IslandSet {
  design::ModuleGraph graph;
  std::vector<design::Jumper> places;
};

int below(std::size_t n, std::mt19937_64& random) {
  return static_cast<int>(random() % n);
}

// Makes connected tiles of the lattice, in the order in which they were added.
std::vector<design::Tile> random_tiles(int size, std::mt19937_64& random) {
  std::vector<design::Tile> tiles{{0, 0, true}};
  while (static_cast<int>(tiles.size()) < size) {
    const design::Tile next = design::across(tiles[random() % tiles.size()], below(3, random)).tile;
    if (std::ranges::count(tiles, next) == 0) tiles.push_back(next);
  }
  return tiles;
}

void add_island(int island, int size, IslandSet& set, std::mt19937_64& random) {
  const std::vector<design::Tile> tiles = random_tiles(size, random);
  const int base = static_cast<int>(set.graph.nodes.size());
  for (const design::Tile& t : tiles) {
    design::ModuleGraph::Node node;
    node.island = island;
    for (int s = 0; s < 3; ++s) {
      const auto other = std::ranges::find(tiles, design::across(t, s).tile);
      if (other == tiles.end()) continue;
      node.neighbour[static_cast<std::size_t>(s)] = base + static_cast<int>(other - tiles.begin());
      node.border[static_cast<std::size_t>(s)] = false;
    }
    set.graph.nodes.push_back(node);
  }
}

// Adds a place between random free sides of two islands, if a few tries find one; `taken` has the places so far.
void add_place(int first, int second, design::ModuleGraph& taken, IslandSet& set, std::mt19937_64& random) {
  for (int tries = 0; tries < 400; ++tries) {
    int a = below(taken.nodes.size(), random), b = below(taken.nodes.size(), random);
    if (taken.nodes[static_cast<std::size_t>(a)].island != first) continue;
    if (taken.nodes[static_cast<std::size_t>(b)].island != second) continue;
    if (a > b) std::swap(a, b);
    auto &na = taken.nodes[static_cast<std::size_t>(a)], &nb = taken.nodes[static_cast<std::size_t>(b)];
    const int sa = below(3, random), sb = below(3, random);
    int &to_b = na.neighbour[static_cast<std::size_t>(sa)], &to_a = nb.neighbour[static_cast<std::size_t>(sb)];
    if (to_b >= 0 || to_a >= 0 || std::ranges::count(na.neighbour, b) > 0) continue;
    to_b = b;
    to_a = a;
    const double length_mm = 1.0 + 0.1 * static_cast<double>(set.places.size());
    set.places.push_back({{a, b}, {sa, sb}, length_mm, 0.0, design::JumperKind::kCable});
    return;
  }
}

// Makes five to eight islands of one to three modules on a ring, with one or two places between neighbours.
IslandSet ring_of_islands(std::mt19937_64& random) {
  IslandSet set;
  const int islands = 5 + below(4, random);
  for (int k = 0; k < islands; ++k) {
    const int left = islands - k - 1, most = 12 - static_cast<int>(set.graph.nodes.size()) - left;
    add_island(k, 1 + below(static_cast<std::size_t>(std::min(3, most)), random), set, random);
  }
  design::ModuleGraph taken = set.graph;
  for (int k = 0; k < islands; ++k) {
    for (int places = 1 + below(2, random); places > 0; --places) add_place(k, (k + 1) % islands, taken, set, random);
  }
  return set;
}

// Makes two or three islands of four to six modules, each too large for a patch of four, with three to six places
// between any two.
IslandSet large_islands(std::mt19937_64& random) {
  IslandSet set;
  const int islands = 2 + below(2, random);
  for (int k = 0; k < islands; ++k) add_island(k, islands == 3 ? 4 : 5 + below(2, random), set, random);
  design::ModuleGraph taken = set.graph;
  for (int a = 0; a < islands; ++a) {
    for (int b = a + 1; b < islands; ++b) {
      for (int places = 3 + below(4, random); places > 0; --places) add_place(a, b, taken, set, random);
    }
  }
  return set;
}

// Cuts a patch of the lattice into islands by seams; jumpers can replace most of the joints that the seams cut.
IslandSet torn_patch(int modules, int seeds, std::mt19937_64& random) {
  const std::vector<design::Tile> tiles = random_tiles(modules, random);
  std::vector<int> island(tiles.size(), -1);
  for (int k = 0; k < seeds; ++k) island[random() % tiles.size()] = k;
  const auto beside = [&](std::size_t v, int side) {
    return static_cast<std::size_t>(std::ranges::find(tiles, design::across(tiles[v], side).tile) - tiles.begin());
  };
  while (std::ranges::count(island, -1) > 0) {
    const std::size_t v = random() % tiles.size(), w = beside(v, below(3, random));
    if (w < tiles.size() && island[v] >= 0 && island[w] < 0) island[w] = island[v];
  }
  IslandSet set;
  set.graph.nodes.resize(tiles.size());
  for (std::size_t v = 0; v < tiles.size(); ++v) {
    set.graph.nodes[v].island = island[v];
    for (int side = 0; side < 3; ++side) {
      const std::size_t w = beside(v, side);
      if (w == tiles.size()) continue;
      const int a = static_cast<int>(v), b = static_cast<int>(w);
      if (island[v] == island[w]) {
        set.graph.nodes[v].neighbour[static_cast<std::size_t>(side)] = b;
        set.graph.nodes[v].border[static_cast<std::size_t>(side)] = false;
      } else if (a < b && random() % 4 != 0) {
        set.places.push_back(
            {{a, b}, {side, design::across(tiles[v], side).side}, 3.0, 0.0, design::JumperKind::kCable});
      }
    }
  }
  return set;
}

// Makes two to four random islands of the lattice, with random places of jumpers between their free sides.
IslandSet random_islands(int modules, std::mt19937_64& random) {
  IslandSet set;
  const int islands = std::min(modules, 2 + static_cast<int>(random() % 3));
  for (int island = 0; island < islands; ++island) {
    const int base = static_cast<int>(set.graph.nodes.size()), left = islands - island - 1;
    const int size =
        left == 0 ? modules - base : 1 + static_cast<int>(random() % static_cast<unsigned>(modules - base - left));
    add_island(island, size, set, random);
  }
  design::ModuleGraph taken = set.graph;
  for (int tries = static_cast<int>(random() % 12); tries > 0; --tries) {
    int a = static_cast<int>(random() % taken.nodes.size()), b = static_cast<int>(random() % taken.nodes.size());
    if (a > b) std::swap(a, b);
    auto &na = taken.nodes[static_cast<std::size_t>(a)], &nb = taken.nodes[static_cast<std::size_t>(b)];
    const int sa = static_cast<int>(random() % 3), sb = static_cast<int>(random() % 3);
    const bool free = na.neighbour[static_cast<std::size_t>(sa)] < 0 && nb.neighbour[static_cast<std::size_t>(sb)] < 0;
    if (na.island == nb.island || !free || std::ranges::count(na.neighbour, b) > 0) continue;
    na.neighbour[static_cast<std::size_t>(sa)] = b;
    nb.neighbour[static_cast<std::size_t>(sb)] = a;
    set.places.push_back(
        {{a, b}, {sa, sb}, 1.0 + 0.1 * static_cast<double>(set.places.size()), 0.0, design::JumperKind::kCable});
  }
  return set;
}

// Returns the number of pieces of a set under the joints of a graph.
int pieces(const design::ModuleGraph& g, unsigned set) {
  int count = 0;
  while (set != 0) {
    unsigned seen = set & (~set + 1), front = seen;
    while (front != 0) {
      const auto v = static_cast<std::size_t>(std::countr_zero(front));
      front &= front - 1;
      for (const int w : g.nodes[v].neighbour) {
        const unsigned bit = w >= 0 ? 1U << w : 0U;
        if ((bit & set & ~seen) == 0) continue;
        seen |= bit;
        front |= bit;
      }
    }
    set &= ~seen;
    ++count;
  }
  return count;
}

struct Cheapest {
  double price;
  int parts, jumpers;
  auto operator<=>(const Cheapest&) const = default;
};

// Searches all partitions for the lowest price, then fewest parts; also for the fewest parts whatever they cost.
std::pair<Cheapest, int> by_trying_everything(const IslandSet& set, int capacity, const design::Price& price) {
  const design::ModuleGraph joined = design::with_jumpers(set.graph, set.places);
  const unsigned all = (1U << set.graph.nodes.size()) - 1;
  std::vector<Cheapest> best(all + 1, {1e9, 1 << 20, 0});
  std::vector<int> fewest(all + 1, 1 << 20), jumpers(all + 1, -1);
  best[0] = {0.0, 0, 0};
  fewest[0] = 0;
  for (unsigned part = 1; part <= all; ++part) {
    if (std::popcount(part) <= capacity && pieces(joined, part) == 1) jumpers[part] = pieces(set.graph, part) - 1;
  }
  for (unsigned rest = 1; rest <= all; ++rest) {
    const unsigned lowest = rest & (~rest + 1);
    for (unsigned part = rest; part != 0; part = (part - 1) & rest) {
      if ((part & lowest) == 0 || jumpers[part] < 0) continue;
      Cheapest with = best[rest & ~part];
      with.price += price.of(1, jumpers[part], 0);
      with.parts += 1;
      with.jumpers += jumpers[part];
      const bool equal = std::abs(with.price - best[rest].price) < 1e-9;
      if (equal ? std::pair(with.parts, with.jumpers) < std::pair(best[rest].parts, best[rest].jumpers)
                : with.price < best[rest].price)
        best[rest] = with;
      fewest[rest] = std::min(fewest[rest], fewest[rest & ~part] + 1);
    }
  }
  return {best[all], fewest[all]};
}

routing::RoutingOptions patches_of_four() {
  routing::RoutingOptions o;
  o.capacity = 4;
  o.lines = 2;
  o.addresses = 2;
  return o;
}

// Expects the cheapest solution, proved, with bounds that hold; returns its controllers and jumpers.
Cheapest expect_cheapest(const IslandSet& set, const routing::RoutingOptions& o, int trial) {
  const routing::RoutingResult r = routing::route(set.graph, set.places, o);
  const auto [cheapest, fewest] = by_trying_everything(set, o.capacity, o.price);
  const int parts = static_cast<int>(r.patches.size()), jumpers = static_cast<int>(r.jumpers.size());
  EXPECT_NEAR(o.price.of(parts, jumpers, 0), cheapest.price, 1e-9) << trial;
  EXPECT_EQ(parts, cheapest.parts) << trial;
  EXPECT_EQ(jumpers, cheapest.jumpers) << trial;
  EXPECT_LE(r.lower_bound, fewest) << trial;
  EXPECT_LE(r.jumpers_lower_bound, jumpers) << trial;
  EXPECT_TRUE(r.price_proved || o.price.jumper >= o.price.controller) << trial;
  return cheapest;
}

TEST(Cost, five_hundred_island_sets_are_divided_as_cheaply_as_by_trying_everything) {
  std::mt19937_64 random(20);
  const std::array<design::Price, 4> prices{{{2.0, 0.25, 0.1}, {0.0, 0.0, 0.0}, {1.0, 0.75, 0.0}, {0.5, 1.0, 0.0}}};
  int with_jumpers = 0, saved = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const IslandSet set = random_islands(3 + trial % 9, random);
    routing::RoutingOptions o = patches_of_four();
    o.price = prices[static_cast<std::size_t>(trial) % 4 == 0 ? random() % 4 : 0];
    const Cheapest cheapest = expect_cheapest(set, o, trial);
    with_jumpers += cheapest.jumpers > 0 ? 1 : 0;
    saved += static_cast<int>(routing::route(set.graph, o).patches.size()) > cheapest.parts ? 1 : 0;
  }
  EXPECT_GT(with_jumpers, 150);
  EXPECT_GT(saved, 150);
}

// On these shapes groups of islands decide: many small islands, islands of several patches, and seams all over. At 1
// and 0.75 one more jumper can cost more or less than it saves.
TEST(Cost, rings_large_islands_and_torn_patches_are_divided_as_cheaply_as_by_trying_everything) {
  std::mt19937_64 random(23);
  int jumpers = 0;
  for (int trial = 0; trial < 360; ++trial) {
    routing::RoutingOptions o = patches_of_four();
    if (trial % 5 == 0) o.price = {1.0, 0.75, 0.0};
    if (trial % 7 == 0) o.capacity = 3 + trial % 2 * 2;
    if (o.capacity > 4) o.addresses = 3;
    const IslandSet set = trial % 3 == 0   ? ring_of_islands(random)
                          : trial % 3 == 1 ? large_islands(random)
                                           : torn_patch(10 + below(3, random), 2 + below(5, random), random);
    jumpers += expect_cheapest(set, o, trial).jumpers;
  }
  EXPECT_GT(jumpers, 600);
}

// Searches all partitions whose jumpers join all islands for the lowest price. Parts are taken one by one, each with
// the least remaining node; `together` gives joined islands the same number.
std::int64_t cheapest_joined(const IslandSet& set, const design::ModuleGraph& joined, int capacity,
                             const routing::IntegerPrice& price, unsigned rest, const std::vector<int>& together) {
  constexpr std::int64_t kNone = std::int64_t{1} << 60;
  if (rest == 0) return std::ranges::count(together, together[0]) == std::ssize(together) ? 0 : kNone;
  std::int64_t best = kNone;
  const unsigned lowest = rest & (~rest + 1);
  for (unsigned part = rest; part != 0; part = (part - 1) & rest) {
    if ((part & lowest) == 0 || std::popcount(part) > capacity || pieces(joined, part) != 1) continue;
    std::vector<int> after = together;
    const auto island = [&](unsigned nodes) {
      return after[static_cast<std::size_t>(set.graph.nodes[static_cast<std::size_t>(std::countr_zero(nodes))].island)];
    };
    for (unsigned nodes = part; nodes != 0; nodes &= nodes - 1)
      std::ranges::replace(after, island(nodes), island(part));
    const std::int64_t of_part = price.of(1, pieces(set.graph, part) - 1);
    best = std::min(best, of_part + cheapest_joined(set, joined, capacity, price, rest & ~part, after));
  }
  return best;
}

// The exact programme alone finds the cheapest of the partitions that join all islands, or a cheaper one, and nothing
// below that price.
TEST(Cost, the_exact_programme_finds_the_cheapest_that_joins_all_islands) {
  std::mt19937_64 random(24);
  const routing::IntegerPrice price(design::Price{});
  int refuted = 0, found = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const IslandSet set = torn_patch(7 + trial % 3, 2 + trial % 3, random);
    const design::ModuleGraph joined = design::with_jumpers(set.graph, set.places);
    const unsigned all = (1U << set.graph.nodes.size()) - 1;
    if (pieces(joined, all) != 1) continue;
    routing::Numbers nodes(set.graph.nodes.size());
    std::iota(nodes.begin(), nodes.end(), 0);
    // The index is the number of an island; numbers that no island has count as joined.
    std::vector<int> islands(5, set.graph.nodes[0].island);
    for (const design::ModuleGraph::Node& n : set.graph.nodes) islands[static_cast<std::size_t>(n.island)] = n.island;
    const routing::JumperGraph g = routing::jumper_graph(joined, set.graph, nodes);
    const std::int64_t least = cheapest_joined(set, joined, 4, price, all, islands);
    for (const std::int64_t limit : {least + 1, least}) {
      long budget = 10'000'000;
      const routing::CheapestParts exact = routing::cheapest_parts(g, 4, price, limit, budget);
      ASSERT_TRUE(exact.decided) << trial;
      ASSERT_TRUE(limit == least || !exact.part_of.empty()) << trial;
      refuted += exact.part_of.empty() ? 1 : 0;
      if (exact.part_of.empty()) continue;
      ++found;
      std::vector<unsigned> parts(static_cast<std::size_t>(exact.parts), 0);
      for (std::size_t v = 0; v < nodes.size(); ++v) parts[static_cast<std::size_t>(exact.part_of[v])] |= 1U << v;
      std::int64_t cost = 0;
      for (const unsigned part : parts) {
        EXPECT_EQ(pieces(joined, part), 1) << trial;
        EXPECT_LE(std::popcount(part), 4) << trial;
        cost += price.of(1, pieces(set.graph, part) - 1);
      }
      EXPECT_LT(cost, limit) << trial;
    }
  }
  EXPECT_GT(refuted, 100);
  EXPECT_GT(found, 100);
}

// A router that gives up at once, or after some questions, still reports only true results: connected parts within
// their capacity, and bounds below what an exhaustive search finds.
TEST(Cost, what_is_found_when_the_router_gives_up_holds) {
  std::mt19937_64 random(21);
  int open = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const IslandSet set = trial % 2 == 0   ? random_islands(8 + trial % 5, random)
                          : trial % 4 == 1 ? ring_of_islands(random)
                                           : torn_patch(11, 5, random);
    routing::RoutingOptions o = patches_of_four();
    o.recombinations = 0;  // These moves would repair small graphs afterwards.
    o.give_up = [questions = trial % 3]() mutable { return questions-- <= 0; };
    const routing::RoutingResult r = routing::route(set.graph, set.places, o);
    const auto [cheapest, fewest] = by_trying_everything(set, o.capacity, o.price);
    const int parts = static_cast<int>(r.patches.size()), jumpers = static_cast<int>(r.jumpers.size());
    EXPECT_GE(o.price.of(parts, jumpers, 0), cheapest.price - 1e-9) << trial;
    EXPECT_LE(r.lower_bound, fewest) << trial;
    EXPECT_TRUE(!r.price_proved || o.price.of(parts, jumpers, 0) < cheapest.price + 1e-9) << trial;
    std::vector<int> times(set.graph.nodes.size(), 0);
    for (const design::Patch& patch : r.patches) {
      EXPECT_LE(patch.modules.size(), 4U) << trial;
      for (const design::RoutedModule& m : patch.modules) ++times[static_cast<std::size_t>(m.node)];
    }
    EXPECT_EQ(std::ranges::count(times, 1), std::ssize(times)) << trial;
    open += r.price_proved ? 0 : 1;
  }
  EXPECT_GT(open, 0);  // The router did give up.
}

// However late it is, islands are joined: a cover of 211 modules had 19 controllers where 14 are enough, because the
// pricing began when the time was over.
TEST(Cost, a_router_that_is_late_from_the_start_still_joins_islands) {
  std::mt19937_64 random(23);
  for (int trial = 0; trial < 6; ++trial) {
    constexpr int kIslands = 12;
    IslandSet set;
    for (int k = 0; k < kIslands; ++k) add_island(k, 5 + below(12, random), set, random);
    design::ModuleGraph taken = set.graph;
    for (int k = 0; k < kIslands; ++k) {
      for (const int step : {1, 2, 3}) add_place(k, (k + step) % kIslands, taken, set, random);
    }
    routing::RoutingOptions o;
    o.failure_analysis = false;
    const routing::RoutingResult in_time = routing::route(set.graph, set.places, o);
    o.give_up = [] { return true; };
    const routing::RoutingResult late = routing::route(set.graph, set.places, o);
    const auto price_of = [&](const routing::RoutingResult& r) {
      return o.price.of(static_cast<int>(r.patches.size()), static_cast<int>(r.jumpers.size()), 0);
    };
    EXPECT_LE(price_of(late), 1.05 * price_of(in_time)) << trial;
  }
}

// The pricing of a layout divides it, and its wiring reuses the division, so the result must equal that of a new
// division.
TEST(Cost, a_division_that_is_known_gives_the_same_wiring) {
  std::mt19937_64 random(22);
  for (int trial = 0; trial < 40; ++trial) {
    const IslandSet set = random_islands(20 + trial, random);
    routing::RoutingOptions o;
    routing::RoutingOptions quick = o;
    quick.failure_analysis = false;
    quick.recombinations = 0;
    quick.threads = 2;
    o.division = routing::route(set.graph, set.places, quick).division;
    // The question must not be asked, because nothing is divided again.
    o.give_up = [] {
      throw std::logic_error("divided again");
      return true;
    };
    const routing::RoutingResult known = routing::route(set.graph, set.places, o),
                                 own = routing::route(set.graph, set.places, {});
    ASSERT_EQ(known.patches.size(), own.patches.size()) << trial;
    for (std::size_t p = 0; p < own.patches.size(); ++p) {
      ASSERT_EQ(known.patches[p].modules.size(), own.patches[p].modules.size()) << trial;
      for (std::size_t m = 0; m < own.patches[p].modules.size(); ++m) {
        EXPECT_EQ(known.patches[p].modules[m].node, own.patches[p].modules[m].node) << trial;
        EXPECT_EQ(known.patches[p].modules[m].line, own.patches[p].modules[m].line) << trial;
      }
    }
    EXPECT_EQ(known.lower_bound, own.lower_bound) << trial;
    EXPECT_EQ(known.jumpers.size(), own.jumpers.size()) << trial;
    EXPECT_EQ(known.price_proved, own.price_proved) << trial;
  }
  routing::RoutingOptions foreign;
  foreign.division = routing::route(random_islands(12, random).graph, foreign).division;
  EXPECT_THROW((void)routing::route(random_islands(30, random).graph, foreign), InputError);
}

TEST(Cost, a_jumper_is_fitted_where_it_costs_less_than_a_controller) {
  // Two single modules that face each other need two controllers alone; a jumper saves one.
  ModuleGraph graph;
  graph.nodes.resize(2);
  graph.nodes[1].island = 1;
  const std::vector<design::Jumper> places{{{0, 1}, {0, 2}, 5.0, 0.0, design::JumperKind::kCable}};
  routing::RoutingOptions o;
  const routing::RoutingResult joined = routing::route(graph, places, o);
  EXPECT_EQ(joined.patches.size(), 1U);
  ASSERT_EQ(joined.jumpers.size(), 1U);
  EXPECT_TRUE(joined.price_proved);
  // The cable leaves by one of the four free sides, and one module is connected to the other by the jumper.
  const design::RoutedModule& hanging = joined.patches[0].modules[1];
  EXPECT_EQ(hanging.rotation, hanging.node == 0 ? 0 : 2);
  o.price = {1.0, 1.5, 0.0};
  EXPECT_EQ(routing::route(graph, places, o).patches.size(), 2U);
  EXPECT_TRUE(routing::route(graph, places, o).jumpers.empty());
}

TEST(Cost, three_islands_of_ten_need_two_controllers_and_two_jumpers) {
  // Strips of ten in a row are joined end to end: 30 modules fit two controllers of 16 only when one strip is cut, so
  // that four pieces need two jumpers. ⌈n / 16⌉ by island and by number alone would give one.
  ModuleGraph graph;
  for (int k = 0; k < 30; ++k) {
    design::ModuleGraph::Node node;
    node.island = k / 10;
    if (k % 10 > 0) node.neighbour[0] = k - 1;
    if (k % 10 < 9) node.neighbour[1] = k + 1;
    node.border = {k % 10 == 0, k % 10 == 9, true};
    graph.nodes.push_back(node);
  }
  const std::vector<design::Jumper> places{{{9, 10}, {1, 0}, 5.0, 0.0, design::JumperKind::kCable},
                                           {{19, 20}, {1, 0}, 5.0, 0.0, design::JumperKind::kCable}};
  const routing::RoutingResult r = routing::route(graph, places);
  EXPECT_EQ(r.patches.size(), 2U);
  EXPECT_EQ(r.jumpers.size(), 2U);
  EXPECT_EQ(r.jumpers_lower_bound, 2);
  EXPECT_TRUE(r.price_proved);
}

TEST(Cost, the_lines_carry_the_capacitance_of_the_jumpers) {
  // Two modules are on two lines, each of which reaches both. By hand: 60 · 0.5 m of cable + 2 of the joint + 10 of
  // the module + 6 of the module passed = 48 pF; with a jumper of 10 mm 60 · 0.01 + 2 more.
  ModuleGraph joint, apart;
  joint.nodes.resize(2);
  joint.nodes[0].neighbour[0] = 1;
  joint.nodes[1].neighbour[0] = 0;
  joint.nodes[0].border[0] = joint.nodes[1].border[0] = false;
  apart.nodes.resize(2);
  routing::RoutingOptions o;
  o.lines = 2;
  o.addresses = 1;
  o.capacity = 2;
  const routing::RoutingResult plain = routing::route(joint, o);
  const routing::RoutingResult bridged =
      routing::route(apart, {{{0, 1}, {0, 0}, 10.0, 0.0, design::JumperKind::kCable}}, o);
  ASSERT_EQ(bridged.patches.size(), 1U);
  EXPECT_DOUBLE_EQ(plain.patches[0].lines[0].capacitance_pf, 48.0);
  EXPECT_DOUBLE_EQ(bridged.patches[0].lines[0].capacitance_pf, 50.6);
}

TEST(Cost, a_failed_jumper_loses_what_hangs_on_it) {
  design::ModuleGraph graph;
  graph.nodes.resize(3);
  graph.nodes[0].neighbour[0] = 1;
  graph.nodes[1].neighbour[0] = 0;
  graph.nodes[0].border[0] = graph.nodes[1].border[0] = false;
  graph.nodes[2].island = 1;
  routing::RoutingOptions o;
  o.second_entry = o.adoption = false;
  const routing::RoutingResult r = routing::route(graph, {{{1, 2}, {1, 1}, 8.0, 0.0, design::JumperKind::kCable}}, o);
  ASSERT_EQ(r.patches.size(), 1U);
  int jumper_rows = 0;
  for (const design::FailureLoss& f : r.patches[0].failures) {
    if (std::minmax(f.node, f.other_node) != std::minmax(1, 2)) continue;
    ++jumper_rows;
    const int below = f.node == 2 ? 1 : 2;
    EXPECT_EQ(f.lost_strapped, below);
    EXPECT_EQ(f.lost_rerouted, below);
  }
  EXPECT_EQ(jumper_rows, 1);
}

}  // namespace
}  // namespace triskin::routing

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <unordered_map>
#include <vector>

#include "jumper_graph.hpp"

namespace triskin::routing {

/// Each bit stands for one island.
using IslandSet = std::uint64_t;
inline constexpr int kMaxIslands = 64;

/// Describes which islands jumpers can join.
struct IslandGraph {
  Numbers weight;                   ///< The weight of an island is its number of modules.
  Numbers alone;                    ///< No partition of the island alone has fewer parts.
  Table<int, IslandSet> neighbour;  ///< A jumper can lead to these islands.
};

/// Finds lower bounds of the price by *groups*: islands that fitted jumpers join, directly or through others. No part
/// spans two groups, and m islands need m - 1 jumpers to be connected. A group costs at least ⌈weight / capacity⌉
/// controllers and m − 1 jumpers, and no partition costs less than the cheapest division of the islands into groups.
/// That division is found exactly: islands are placed one by one; a state keeps the groups that can still grow.
class IslandGroups {
 public:
  /// Lists the least cost of groups for which more is known than price_of(); never below it.
  using Known = std::unordered_map<IslandSet, std::int64_t>;
  struct Division {
    std::int64_t price = 0;
    std::vector<IslandSet> groups;
  };

  /// The graph must be connected and have no more than kMaxIslands islands. Divisions that cost `limit` or more are
  /// left out. Cost: up to `budget` transitions between states.
  IslandGroups(IslandGraph graph, int capacity, const IntegerPrice& price, std::int64_t limit, long budget);

  /// Returns the least price by weights alone, or the limit; nothing if the budget ended first.
  [[nodiscard]] std::optional<std::int64_t> least() const;
  /// Returns the price of one group, by its weight.
  [[nodiscard]] std::int64_t price_of(IslandSet group) const;
  /// Returns the cheapest division below `limit`, which may not rise; without groups if there is none. Returns nothing
  /// if least() has no value or the budget, which is counted down, ended first.
  [[nodiscard]] std::optional<Division> cheapest(const Known& known, std::int64_t limit, long& budget) const;

 private:
  struct Group {
    // `growing` has the islands with neighbours still to be placed, `islands` all of them.
    IslandSet growing = 0, islands = 0;
    int weight = 0;  // The weight counts modules.
    auto operator<=>(const Group&) const = default;
  };
  using State = std::vector<Group>;  // A state holds only groups that can still grow, sorted.
  struct Way {
    State state;
    std::vector<IslandSet> closed;
    std::int64_t price = 0;  // The transition adds this price, by the weights.
  };
  using Key = std::vector<IslandSet>;
  struct KeyHash {
    std::size_t operator()(const Key& key) const;
  };
  template <typename Value>
  using ByKey = std::unordered_map<Key, Value, KeyHash>;
  struct Layer {
    int island = -1;         // This island is placed next.
    IslandSet can_grow = 0;  // These islands still have unplaced neighbours once it is placed.
    int weight_to_come = 0;  // This weight is still to be placed, including this island.
    Table<int, State> state;
    Table<int, std::int64_t> price, to_come;  // `price` is exact so far; `to_come` is a lower bound of the rest.
    ByKey<Numbers> alike;                     // The key tells which islands can grow in each group.
  };
  struct Arc {
    int from, to;  // `from` numbers a state in a layer, `to` one in the next layer.
    std::int64_t price;
  };
  struct Best {
    std::int64_t price = 0;
    const State* before = nullptr;  // The state belongs to the previous layer.
    std::vector<IslandSet> closed;
  };

  [[nodiscard]] IslandSet growing(IslandSet placed) const;
  [[nodiscard]] Numbers order() const;
  template <typename Visit>
  bool for_each_way(const State& state, const Layer& layer, const Visit& visit) const;
  [[nodiscard]] std::int64_t price_of(const Group& g) const;
  [[nodiscard]] int parts_of(int weight) const;
  [[nodiscard]] int saved_together(const Group& g) const;
  [[nodiscard]] int free_places(const Group& g) const;
  [[nodiscard]] Key key_of(const State& state) const;
  [[nodiscard]] static Key pattern_of(const State& state);
  [[nodiscard]] std::int64_t filled(const State& state, int weight_to_come) const;
  [[nodiscard]] std::int64_t lacking(const State& state, const State& other) const;
  [[nodiscard]] std::int64_t to_come(const State& state, const Layer& layer, long& budget) const;
  bool lay_out(long budget);
  bool advance(Layer& next, long& budget, std::vector<Arc>& arcs) const;
  bool thin(Layer& layer, long& budget, std::vector<Arc>& arcs) const;

  IslandGraph graph_;
  int capacity_;
  IntegerPrice price_;
  std::int64_t limit_;
  Table<int, Layer> layers_;  // No layers exist if the budget ended.
};

}  // namespace triskin::routing

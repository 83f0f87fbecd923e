// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <unordered_map>
#include <vector>

#include "triskin/routing/jumper_graph.hpp"

namespace triskin::geometry {

/// A set of islands, one bit each.
using IslandSet = std::uint64_t;
inline constexpr int kMaxIslands = 64;

/// Islands that jumpers can join.
struct IslandGraph {
  std::vector<int> weight;           ///< Each is a number of modules.
  std::vector<int> alone;            ///< No partition of the island alone has fewer parts.
  std::vector<IslandSet> neighbour;  ///< A jumper can lead to these islands.
};

/// Lower bounds of the price by *groups*: islands that fitted jumpers join, directly or over others. No part reaches
/// over two groups, and m islands need m - 1 jumpers to hang together. A group costs at least ⌈weight / capacity⌉
/// controllers and m − 1 jumpers, and no partition costs less than the cheapest division of the islands into groups.
/// That is found exactly: islands are placed one by one; a state keeps the groups that can still grow.
class IslandGroups {
 public:
  /// What groups cost at least where more is known than price_of(), never less.
  using Known = std::unordered_map<IslandSet, std::int64_t>;
  struct Division {
    std::int64_t price = 0;
    std::vector<IslandSet> groups;
  };

  /// The graph is connected and has no more than kMaxIslands islands. Divisions that cost `limit` or more are left
  /// out. Cost: up to `budget` transitions between states.
  IslandGroups(IslandGraph graph, int capacity, const IntegerPrice& price, std::int64_t limit, long budget);

  /// The least price by weights alone, or the limit; none where the budget ended first.
  [[nodiscard]] std::optional<std::int64_t> least() const;
  /// Price of one group, by its weight.
  [[nodiscard]] std::int64_t price_of(IslandSet group) const;
  /// The cheapest division below `limit`, which may not rise; without groups where there is none. Nothing where least()
  /// has no value or the budget, which is counted down, ended first.
  [[nodiscard]] std::optional<Division> cheapest(const Known& known, std::int64_t limit, long& budget) const;

 private:
  struct Group {
    IslandSet growing = 0, islands = 0;  // Islands with neighbours to come, and all islands.
    int weight = 0;                      // Counted in modules.
    auto operator<=>(const Group&) const = default;
  };
  using State = std::vector<Group>;  // Holds only groups that can still grow, sorted.
  struct Way {
    State state;
    std::vector<IslandSet> closed;
    std::int64_t price = 0;  // Price, by the weights, of what the transition adds.
  };
  using Key = std::vector<IslandSet>;
  struct KeyHash {
    std::size_t operator()(const Key& key) const;
  };
  template <typename Value>
  using ByKey = std::unordered_map<Key, Value, KeyHash>;
  struct Layer {
    int island = -1;                           // Island that is placed next.
    IslandSet can_grow = 0;                    // Islands that still have neighbours to come once it is placed.
    int weight_to_come = 0;                    // Weight still to be placed, including this island.
    std::vector<State> state;                  // Indexed by number.
    std::vector<std::int64_t> price, to_come;  // Exact price so far, and a lower bound of what follows.
    ByKey<std::vector<int>> alike;             // States, keyed by what can grow in each group.
  };
  struct Arc {
    int from, to;  // Numbers of states in a layer and in the next one.
    std::int64_t price;
  };
  struct Best {
    std::int64_t price = 0;
    const State* before = nullptr;  // State in the previous layer.
    std::vector<IslandSet> closed;
  };

  [[nodiscard]] IslandSet growing(IslandSet placed) const;
  [[nodiscard]] std::vector<int> order() const;
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
  std::vector<Layer> layers_;  // Empty if the budget ended.
};

}  // namespace triskin::geometry

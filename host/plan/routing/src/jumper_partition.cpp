// SPDX-License-Identifier: GPL-3.0-or-later
#include "jumper_partition.hpp"

#include <algorithm>
#include <bit>
#include <map>
#include <optional>

#include "island_groups.hpp"
#include "jumper_frontier.hpp"
#include "jumper_search.hpp"
#include "partition.hpp"

namespace triskin::routing {
namespace {

// The budgets count state transitions; the larger one takes about 0.3 s.
constexpr long kFirstGroupBudget = 30'000, kGroupBudget = 500'000;
constexpr long kExactBudget = 4'000'000;  // The budget counts state transitions, which take about 0.3 s.
constexpr long kPeelBudget = 200'000;     // The budget counts node visits, which take about 3 ms.

class JumperPartitioner {
 public:
  JumperPartitioner(const JumperGraph& g, int capacity, const Price& price, std::uint64_t seed,
                    const std::function<bool()>& give_up)
      : g_(g),
        capacity_(capacity),
        price_(price),
        seed_(seed),
        give_up_(give_up),
        random_(seed),
        islands_(components(g.apart)) {}

  JumperPartition run() {
    const Partition together = partition(g_.joined, capacity_, seed_, give_up_);
    divide_islands();
    best_.offer(g_, price_, together.part_of, together.parts);
    bound_ = price_.jumpers_pay() ? price_.of(together.lower_bound, std::max(0, pieces_bound_ - together.lower_bound))
                                  : price_.of(pieces_bound_, 0);
    if (price_.jumpers_pay()) close_the_gap();
    JumperPartition p{best_.part_of, best_.parts, best_.jumpers, together.lower_bound, 0, met()};
    p.jumpers_bound = met() ? best_.jumpers : jumpers_bound();
    return p;
  }

 private:
  [[nodiscard]] std::int64_t cost() const { return price_.of(best_.parts, best_.jumpers); }
  [[nodiscard]] bool met() const { return cost() <= bound_; }
  [[nodiscard]] bool is_late() const { return give_up_ && give_up_(); }
  // Returns a lower bound of the jumpers for as many parts as the best has.
  [[nodiscard]] int jumpers_bound() const {
    const std::int64_t of_jumpers = bound_ - price_.of(best_.parts, 0);
    const std::int64_t by_price = of_jumpers <= 0 ? 0 : (of_jumpers + price_.jumper - 1) / price_.jumper;
    return std::max(static_cast<int>(by_price), pieces_bound_ - best_.parts);
  }

  // Divides every island alone, to find the need without jumpers and the least number of pieces of the islands.
  void divide_islands() {
    Numbers part_of(g_.apart.node.size(), -1);
    int parts = 0;
    for (const Numbers& island : islands_) {
      const Partition p = partition(part_of_graph(g_, island).apart, capacity_, seed_, give_up_);
      pieces_bound_ += p.lower_bound;
      alone_.push_back(p.lower_bound);
      for (std::size_t k = 0; k < island.size(); ++k) part_of[island[k]] = parts + p.part_of[k];
      parts += p.parts;
    }
    best_.offer(g_, price_, part_of, parts);
  }

  void close_the_gap() {
    std::optional<IslandGroups> groups;
    bound_by_groups(kFirstGroupBudget, groups);
    if (!met()) search_division(g_, capacity_, price_, bound_, random_, give_up_, best_);
    if (groups && !groups->least()) bound_by_groups(kGroupBudget, groups);
    if (groups && groups->least()) settle_groups(*groups);
  }

  void bound_by_groups(long budget, std::optional<IslandGroups>& groups) {
    if (met() || is_late() || islands_.size() > at(kMaxIslands)) return;
    groups.emplace(island_graph(), capacity_, price_, cost(), budget);
    bound_ = std::max(bound_, groups->least().value_or(bound_));
  }

  // Raises the bound by at most one jumper at a time: far fewer divisions lie below that than below the best.
  void settle_groups(const IslandGroups& groups) {
    long budget = kGroupBudget;
    while (!met() && !is_late()) {
      const std::int64_t limit = std::min(cost(), bound_ + price_.jumper);
      const auto division = groups.cheapest(known_, limit, budget);
      if (!division) return;
      bound_ = std::max(bound_, division->groups.empty() ? limit : division->price);
      if (!met() && !division->groups.empty() && !settle(groups, *division)) return;
    }
  }

  [[nodiscard]] IslandGraph island_graph() const {
    Numbers island_of(g_.joined.node.size());
    IslandGraph graph;
    for (std::size_t k = 0; k < islands_.size(); ++k) {
      graph.weight.push_back(static_cast<int>(islands_[k].size()));
      for (const int v : islands_[k]) island_of[v] = static_cast<int>(k);
    }
    graph.alone = alone_;
    graph.neighbour.assign(islands_.size(), 0);
    for (int v = 0; v < g_.joined.size(); ++v) {
      for (std::size_t s = 0; s < 3; ++s) {
        if (g_.over_jumper[v][s]) graph.neighbour[island_of[v]] |= IslandSet{1} << island_of[g_.joined.neighbour[v][s]];
      }
    }
    for (std::size_t k = 0; k < islands_.size(); ++k) graph.neighbour[k] &= ~(IslandSet{1} << k);
    return graph;
  }

  // Keeps what is known of a group: no division that joins all its islands costs less than `least`.
  struct Settled {
    JumperGraph graph;  // `node` is here the local node of the whole graph.
    std::int64_t least = 0;
    JumperDivision best;
    bool too_large = false;  // True if the exact programme could not solve it because of its size.
  };
  [[nodiscard]] std::int64_t price_of(const JumperDivision& d) const { return price_.of(d.parts, d.jumpers); }

  // Works on the groups of a division until one is dearer than known before; if none is, their own best together may be
  // cheaper than the best of the whole. Returns false if nothing was gained, because then nothing can be.
  bool settle(const IslandGroups& groups, const IslandGroups::Division& division) {
    bool gained = false;
    for (const IslandSet group : division.groups) {
      Settled& s = settled(groups, group);
      const std::int64_t limit = cost() - (division.price - s.least);
      if (s.too_large || price_of(s.best) <= s.least) continue;
      const std::int64_t before = s.least;
      raise(s, limit);
      known_[group] = s.least;
      gained = gained || !s.too_large;
      if (s.least > before) return true;
    }
    Numbers part_of(g_.joined.node.size(), -1);
    int parts = 0;
    for (const IslandSet group : division.groups) {
      const Settled& s = settled_.at(group);
      for (std::size_t k = 0; k < s.best.part_of.size(); ++k)
        part_of[s.graph.joined.node[k]] = parts + s.best.part_of[k];
      parts += s.best.parts;
    }
    return best_.offer(g_, price_, part_of, parts) || gained;
  }

  Settled& settled(const IslandGroups& groups, IslandSet group) {
    const auto [found, is_new] = settled_.try_emplace(group);
    Settled& s = found->second;
    if (!is_new) return s;
    Numbers nodes;
    for (IslandSet rest = group; rest != 0; rest &= rest - 1) {
      const auto& island = islands_[std::countr_zero(rest)];
      nodes.insert(nodes.end(), island.begin(), island.end());
    }
    std::ranges::sort(nodes);
    s.graph = part_of_graph(g_, nodes);
    s.least = groups.price_of(group);
    Numbers part_of;
    const int fewest = (s.graph.joined.size() + capacity_ - 1) / capacity_;
    if (peel(s.graph.joined, capacity_, fewest, kPeelBudget, random_, part_of))
      s.best.offer(s.graph, price_, part_of, fewest);
    search_division(s.graph, capacity_, price_, s.least, random_, give_up_, s.best);
    return s;
  }

  // Finds a division of the group that costs `least`, or raises `least`: up to the limit, by at most one jumper.
  void raise(Settled& s, std::int64_t limit) {
    const std::int64_t next = std::min({price_of(s.best), limit, s.least + price_.jumper});
    const CheapestParts exact = cheapest_parts(s.graph, capacity_, price_, next, exact_budget_);
    s.too_large = !exact.decided;
    if (!exact.decided) return;
    if (!exact.part_of.empty()) s.best.offer(s.graph, price_, exact.part_of, exact.parts);
    s.least = exact.part_of.empty() ? next : price_of(s.best);
  }

  const JumperGraph& g_;
  int capacity_;
  IntegerPrice price_;
  std::uint64_t seed_;
  const std::function<bool()>& give_up_;
  Dice random_;
  Table<int, Numbers> islands_;
  Numbers alone_;  // No partition of the island alone has fewer parts.
  JumperDivision best_;
  int pieces_bound_ = 0;
  std::int64_t bound_ = 0;
  long exact_budget_ = kExactBudget;
  IslandGroups::Known known_;
  std::map<IslandSet, Settled> settled_;
};

}  // namespace

JumperPartition partition_with_jumpers(const JumperGraph& g, int capacity, const Price& price, std::uint64_t seed,
                                       const std::function<bool()>& give_up) {
  return JumperPartitioner(g, capacity, price, seed, give_up).run();
}

}  // namespace triskin::routing

// SPDX-License-Identifier: GPL-3.0-or-later
#include "island_groups.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

namespace triskin::routing {
namespace {

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max() / 4;

IslandSet only(int island) {
  return IslandSet{1} << island;
}
bool has(IslandSet set, int island) {
  return (set >> island & 1) != 0;
}

}  // namespace

std::size_t IslandGroups::KeyHash::operator()(const Key& key) const {
  std::uint64_t h = 0;
  for (const IslandSet k : key) h = (h ^ k ^ (h >> 29)) * 0x9E3779B97F4A7C15ULL;
  return static_cast<std::size_t>(h ^ (h >> 32));
}

IslandGroups::IslandGroups(IslandGraph graph, int capacity, const IntegerPrice& price, std::int64_t limit, long budget)
    : graph_(std::move(graph)), capacity_(capacity), price_(price), limit_(limit) {
  if (!lay_out(budget)) layers_.clear();
}

std::optional<std::int64_t> IslandGroups::least() const {
  if (layers_.empty()) return std::nullopt;
  return std::min(limit_, layers_[0].to_come[0]);
}

int IslandGroups::parts_of(int weight) const {
  return (weight + capacity_ - 1) / capacity_;
}

std::int64_t IslandGroups::price_of(IslandSet islands) const {
  Group group{0, islands, 0};
  for (IslandSet rest = islands; rest != 0; rest &= rest - 1) group.weight += graph_.weight[std::countr_zero(rest)];
  return price_of(group);
}
std::int64_t IslandGroups::price_of(const Group& g) const {
  return price_.of(parts_of(g.weight) + saved_together(g), std::popcount(g.islands) - 1);
}

// Returns the islands of `placed` that have unplaced neighbours.
IslandSet IslandGroups::growing(IslandSet placed) const {
  IslandSet growing = 0;
  for (IslandSet rest = placed; rest != 0; rest &= rest - 1) {
    const int u = std::countr_zero(rest);
    if ((graph_.neighbour[u] & ~placed) != 0) growing |= only(u);
  }
  return growing;
}

// Tries each start. The next island is the neighbour after which the fewest can grow; ties are won by the one with most
// neighbours placed. The order with the least Σ 4^(how many can grow) is taken.
Numbers IslandGroups::order() const {
  const int n = static_cast<int>(graph_.weight.size());
  double least = std::numeric_limits<double>::infinity();
  Numbers best;
  for (int start = 0; start < n; ++start) {
    Numbers order{start};
    double cost = 0.0;
    for (IslandSet placed = only(start); static_cast<int>(order.size()) < n && cost < least;) {
      std::tuple<int, int, int> next{n + 1, 0, -1};
      for (int v = 0; v < n; ++v) {
        const int placed_beside = std::popcount(graph_.neighbour[v] & placed);
        if (!has(placed, v) && placed_beside > 0)
          next = std::min(next, {std::popcount(growing(placed | only(v))), -placed_beside, v});
      }
      order.push_back(std::get<2>(next));
      placed |= only(order.back());
      cost += std::ldexp(1.0, 2 * std::get<0>(next));
    }
    if (static_cast<int>(order.size()) < n || cost >= least) continue;
    least = cost;
    best = std::move(order);
  }
  return best;
}

// Visits the island alone and with any of the groups that it touches; returns false if `visit` does.
template <typename Visit>
bool IslandGroups::for_each_way(const State& state, const Layer& layer, const Visit& visit) const {
  const Group mine{layer.can_grow & only(layer.island), only(layer.island), graph_.weight[layer.island]};
  State touched;
  Way apart;
  const auto put = [&](Way& way, Group g) {
    g.growing = g.islands & layer.can_grow;
    if (g.growing != 0)
      way.state.push_back(g);
    else
      way.closed.push_back(g.islands);
  };
  for (const Group& g : state) {
    if ((g.growing & graph_.neighbour[layer.island]) != 0)
      touched.push_back(g);
    else
      put(apart, g);
  }
  for (IslandSet joined = 0; joined >> touched.size() == 0; ++joined) {
    Way way = apart;
    Group together = mine;
    for (std::size_t k = 0; k < touched.size(); ++k) {
      if (!has(joined, static_cast<int>(k))) {
        put(way, touched[k]);
        continue;
      }
      together.islands |= touched[k].islands;
      together.weight += touched[k].weight;
      way.price -= price_of(touched[k]);
    }
    way.price += price_of(together);
    put(way, together);
    std::ranges::sort(way.state);
    if (!visit(std::move(way))) return false;
  }
  return true;
}

// Returns the parts that an island alone needs beyond its weight, and saves when it is joined to others.
int IslandGroups::saved_together(const Group& g) const {
  return std::has_single_bit(g.islands) ? graph_.alone[std::countr_zero(g.islands)] - parts_of(g.weight) : 0;
}
int IslandGroups::free_places(const Group& g) const {
  return (parts_of(g.weight) + saved_together(g)) * capacity_ - g.weight;
}

// The rest depends on where a group can grow, its free places, and what it saves when it is joined to others.
IslandGroups::Key IslandGroups::key_of(const State& state) const {
  Key key;
  key.reserve(2 * state.size());
  for (const Group& g : state) {
    key.push_back(g.growing);
    key.push_back(static_cast<IslandSet>(free_places(g)) << 32 | static_cast<IslandSet>(saved_together(g)));
  }
  return key;
}

IslandGroups::Key IslandGroups::pattern_of(const State& state) {
  Key pattern;
  for (const Group& g : state) pattern.push_back(g.growing);
  return pattern;
}

// Returns the least that later islands add: as if they could fill all free places, and the free places could then be
// saved, as groups that are joined save controllers.
std::int64_t IslandGroups::filled(const State& state, int weight_to_come) const {
  for (const Group& g : state) weight_to_come -= free_places(g);
  return price_.of(weight_to_come > 0 ? parts_of(weight_to_come) : -(-weight_to_come / capacity_), 0);
}

// Returns the price of the controllers that give the groups of `other`, of the same pattern, as many free places as
// those of `state` have. With them everything that follows `state` can follow `other` at the same price or a lower one.
std::int64_t IslandGroups::lacking(const State& state, const State& other) const {
  int parts = 0;
  for (std::size_t g = 0; g < state.size(); ++g)
    parts += parts_of(std::max(0, free_places(state[g]) - free_places(other[g])));
  return price_.of(parts, 0);
}

// Returns a lower bound of the remaining price, also for a state that the layer lacks.
std::int64_t IslandGroups::to_come(const State& state, const Layer& layer, long& budget) const {
  std::int64_t least = filled(state, layer.weight_to_come);
  const auto alike = layer.alike.find(pattern_of(state));
  if (alike == layer.alike.end()) return least;
  budget -= static_cast<long>(alike->second.size() / 32);
  for (const int k : alike->second) least = std::max(least, layer.to_come[k] - lacking(state, layer.state[k]));
  return least;
}

// Computes all states forwards, then the least remaining price of each backwards. Returns false if the budget ended.
bool IslandGroups::lay_out(long budget) {
  std::vector<std::vector<Arc>> arcs;
  layers_.emplace_back();
  layers_[0].state = {{}};
  layers_[0].price = {0};
  layers_[0].weight_to_come = std::accumulate(graph_.weight.begin(), graph_.weight.end(), 0);
  IslandSet placed = 0;
  for (const int v : order()) {
    layers_.back().island = v;
    layers_.back().can_grow = growing(placed |= only(v));
    Layer next;
    next.weight_to_come = layers_.back().weight_to_come - graph_.weight[v];
    if (!advance(next, budget, arcs.emplace_back())) return false;
    layers_.push_back(std::move(next));
  }
  layers_.back().to_come.assign(layers_.back().state.size(), 0);
  for (std::size_t layer = arcs.size(); layer-- > 0;) {
    Layer& l = layers_[layer];
    // States that would reach the limit were left out, so the bound ends there.
    for (const std::int64_t price : l.price) l.to_come.push_back(limit_ - price);
    for (const Arc& a : arcs[layer])
      l.to_come[a.from] = std::min(l.to_come[a.from], a.price + layers_[layer + 1].to_come[a.to]);
  }
  return true;
}

// Makes the states of the next layer from those of the last one.
bool IslandGroups::advance(Layer& next, long& budget, std::vector<Arc>& arcs) const {
  const Layer& now = layers_.back();
  ByKey<int> number;
  for (std::size_t k = 0; k < now.state.size(); ++k) {
    const bool in_budget = for_each_way(now.state[k], now, [&](Way&& way) {
      if (--budget < 0) return false;
      const std::int64_t price = now.price[k] + way.price;
      if (price + filled(way.state, next.weight_to_come) >= limit_) return true;
      const auto [found, is_new] = number.try_emplace(key_of(way.state), static_cast<int>(next.state.size()));
      if (is_new) {
        next.state.push_back(std::move(way.state));
        next.price.push_back(price);
      }
      next.price[found->second] = std::min(next.price[found->second], price);
      arcs.push_back({static_cast<int>(k), found->second, way.price});
      return true;
    });
    if (!in_budget) return false;
  }
  return thin(next, budget, arcs);
}

// Drops states that another can replace: with the controllers that it lacks the other one is no dearer.
bool IslandGroups::thin(Layer& layer, long& budget, std::vector<Arc>& arcs) const {
  Numbers order(layer.state.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](int k) { return layer.price[k]; });
  Layer kept;
  Table<int, std::pair<int, std::int64_t>> standin(order.size(), {-1, 0});
  for (const int k : order) {
    const State& state = layer.state[k];
    Numbers& others = kept.alike[pattern_of(state)];
    for (const int other : others) {
      const std::int64_t more = lacking(state, kept.state[other]);
      if (kept.price[other] + more > layer.price[k]) continue;
      standin[k] = {other, more};
      break;
    }
    if ((budget -= static_cast<long>(others.size() / 32)) < 0) return false;
    if (standin[k].first >= 0) continue;
    standin[k].first = static_cast<int>(kept.state.size());
    others.push_back(standin[k].first);
    kept.state.push_back(state);
    kept.price.push_back(layer.price[k]);
  }
  for (Arc& a : arcs) {
    const auto& [number, more] = standin[a.to];
    a.to = number;
    a.price -= more;
  }
  layer.state = std::move(kept.state);
  layer.price = std::move(kept.price);
  layer.alike = std::move(kept.alike);
  return true;
}

// Like lay_out(), but the states hold the groups themselves, so that known facts count when a group closes.
std::optional<IslandGroups::Division> IslandGroups::cheapest(const Known& known, std::int64_t limit,
                                                             long& budget) const {
  if (layers_.empty()) return std::nullopt;
  std::vector<std::map<State, Best>> best(layers_.size());
  best[0][{}] = {};
  for (std::size_t layer = 0; layer + 1 < layers_.size(); ++layer) {
    ByKey<std::int64_t> follows;
    for (const auto& [state, mine] : best[layer]) {
      const bool in_budget = for_each_way(state, layers_[layer], [&](Way&& way) {
        if (--budget < 0) return false;
        std::int64_t price = mine.price + way.price;
        for (const IslandSet group : way.closed) {
          if (const auto found = known.find(group); found != known.end()) price += found->second - price_of(group);
        }
        const auto [found, is_new] = follows.try_emplace(key_of(way.state), 0);
        if (is_new) found->second = to_come(way.state, layers_[layer + 1], budget);
        if (price + found->second >= limit) return true;
        Best& there = best[layer + 1].try_emplace(std::move(way.state), Best{kNever, nullptr, {}}).first->second;
        if (price < there.price) there = {price, &state, std::move(way.closed)};
        return true;
      });
      if (!in_budget) return std::nullopt;
    }
  }
  Division division;
  if (best.back().empty()) return division;
  const State* state = &best.back().begin()->first;
  division.price = best.back().begin()->second.price;
  for (std::size_t layer = layers_.size() - 1; layer > 0; --layer) {
    const Best& b = best[layer].at(*state);
    division.groups.insert(division.groups.end(), b.closed.begin(), b.closed.end());
    state = b.before;
  }
  return division;
}

}  // namespace triskin::routing

// SPDX-License-Identifier: GPL-3.0-or-later
#include "jumper_frontier.hpp"

#include <algorithm>
#include <numeric>
#include <unordered_map>

#include "disjoint_sets.hpp"
#include "frontier_blocks.hpp"

namespace triskin::geometry {
namespace {

struct State {
  FrontierKey key;
  std::int64_t cost = 0;  // of closed parts and of jumpers
  int before = -1;
  unsigned joined = 0;  // sides over which the node joined its neighbour's part
};
std::vector<int> all_nodes(const LocalGraph& g) {
  std::vector<int> nodes(at(g.size()));
  std::iota(nodes.begin(), nodes.end(), 0);
  return nodes;
}

class CheapestPartition {
 public:
  CheapestPartition(const JumperGraph& g, int capacity, const IntegerPrice& price, std::int64_t limit, long budget)
      : graph_(g),
        g_(g.joined),
        capacity_(capacity),
        price_(price),
        limit_(limit),
        budget_(budget),
        order_(order_for_small_frontier(g_, all_nodes(g_))) {}

  CheapestParts run() {
    if (order_.widest > kMaxFrontier) return {};
    layers_.push_back({State{}});
    std::vector<int> frontier;
    int to_come = g_.size();
    for (const int v : order_.nodes) {
      if (!add(v, frontier, --to_come)) return {};
      if (layers_.back().empty()) return {true, {}, 0};
    }
    return read_back();
  }

 private:
  bool add(int v, std::vector<int>& frontier, int to_come) {
    step_.clear();
    next_.clear();
    std::vector<int> nodes = frontier;
    nodes.push_back(v);
    std::vector<bool> stays(nodes.size());
    placed_.resize(at(g_.size()), false);
    placed_[at(v)] = true;
    for (std::size_t s = 0; s < nodes.size(); ++s) {
      stays[s] = std::ranges::any_of(g_.neighbour[at(nodes[s])], [&](int w) { return w >= 0 && !placed_[at(w)]; });
    }
    const std::vector<State>& now = layers_.back();
    for (std::size_t i = 0; i < now.size(); ++i) {
      if ((budget_ -= 4) < 0) return false;
      expand(now[i], static_cast<int>(i), v, frontier, stays, to_come);
    }
    frontier.clear();
    for (std::size_t s = 0; s < nodes.size(); ++s) {
      if (stays[s]) frontier.push_back(nodes[s]);
    }
    layers_.push_back(std::move(next_));
    next_ = {};
    return true;
  }

  // All ways to join v to the blocks of its neighbours; to a block that a joint and a jumper lead to, over the joint.
  void expand(const State& state, int index, int v, const std::vector<int>& frontier, const std::vector<bool>& stays,
              int to_come) {
    const FrontierBlocks blocks = unpack_blocks(state.key, frontier.size());
    std::array<int, 3> block_at{-1, -1, -1};
    for (const bool over_jumper : {false, true}) {
      for (std::size_t s = 0; s < 3; ++s) {
        if (graph_.over_jumper[at(v)][s] != over_jumper) continue;
        const auto position = std::ranges::find(frontier, g_.neighbour[at(v)][s]);
        if (g_.neighbour[at(v)][s] < 0 || position == frontier.end()) continue;
        const int label = blocks.label[static_cast<std::size_t>(position - frontier.begin())];
        if (std::ranges::count(block_at, label) == 0) block_at[s] = label;
      }
    }
    for (unsigned joined = 0; joined < 8; ++joined) {
      int weight = 1;
      bool valid = true;
      std::int64_t cost = state.cost;
      for (std::size_t s = 0; s < 3; ++s) {
        if ((joined >> s & 1) == 0) continue;
        valid = valid && block_at[s] >= 0;
        if (!valid) break;
        weight += blocks.weight[at(block_at[s])];
        cost += graph_.over_jumper[at(v)][s] ? price_.jumper : 0;
      }
      if (valid && weight <= capacity_) commit({{}, cost, index, joined}, blocks, block_at, weight, stays, to_come);
    }
  }

  void commit(State s, const FrontierBlocks& before, const std::array<int, 3>& block_at, int weight,
              const std::vector<bool>& stays, int to_come) {
    const NextFrontier next = next_frontier(before, s.joined, block_at, weight, stays);
    s.key = next.key;
    s.cost += price_.part * next.closed;
    if (s.cost + price_.part * ((next.open_weight + to_come + capacity_ - 1) / capacity_) >= limit_) return;
    --budget_;
    const auto [found, is_new] = step_.try_emplace(s.key, static_cast<int>(next_.size()));
    if (is_new)
      next_.push_back(s);
    else if (s.cost < next_[at(found->second)].cost)
      next_[at(found->second)] = s;
  }

  [[nodiscard]] CheapestParts read_back() const {
    DisjointSets sets(at(g_.size()));
    const State* state = &layers_.back()[0];
    for (std::size_t layer = order_.nodes.size(); layer > 0; --layer) {
      const int v = order_.nodes[layer - 1];
      for (std::size_t s = 0; s < 3; ++s) {
        if ((state->joined >> s & 1) != 0) sets.join(v, g_.neighbour[at(v)][s]);
      }
      state = &layers_[layer - 1][at(state->before)];
    }
    CheapestParts answer{true, std::vector<int>(at(g_.size()), -1), 0};
    std::vector<int> number(at(g_.size()), -1);
    for (int v = 0; v < g_.size(); ++v) {
      int& part = number[at(sets.find(v))];
      if (part < 0) part = answer.parts++;
      answer.part_of[at(v)] = part;
    }
    return answer;
  }

  const JumperGraph& graph_;
  const LocalGraph& g_;
  int capacity_;
  const IntegerPrice& price_;
  std::int64_t limit_;
  long budget_;
  std::vector<bool> placed_;
  FrontierOrder order_;
  std::vector<std::vector<State>> layers_;
  std::vector<State> next_;
  std::unordered_map<FrontierKey, int, FrontierKeyHash> step_;
};

}  // namespace

CheapestParts cheapest_parts(const JumperGraph& g, int capacity, const IntegerPrice& price, std::int64_t limit,
                             long budget) {
  return CheapestPartition(g, capacity, price, limit, budget).run();
}

}  // namespace triskin::geometry

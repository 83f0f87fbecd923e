// SPDX-License-Identifier: GPL-3.0-or-later
#include "frontier.hpp"

#include <algorithm>
#include <unordered_map>

#include "frontier_blocks.hpp"
#include "triskin/base/disjoint_sets.hpp"

namespace triskin::routing {
namespace {

struct State {
  FrontierKey key;
  int closed = 0;
  int before = -1;      // The state belongs to the previous layer.
  unsigned joined = 0;  // At these sides the node joined its neighbour's part.
  bool keeps_branch = true;
};

class FrontierProgramme {
 public:
  FrontierProgramme(const LocalGraph& g, const Folding& folding, int capacity, int k, long budget)
      : g_(g),
        folding_(folding),
        capacity_(capacity),
        k_(k - static_cast<int>(folding.closed.size())),
        budget_(budget),
        in_core_(g.node.size(), false),
        order_(order_for_small_frontier(g, folding.core)) {
    for (const int v : folding.core) in_core_[v] = true;
  }

  FrontierAnswer run() {
    if (order_.widest > kMaxFrontier) return {};
    layers_.push_back({State{}});
    Numbers frontier;
    int to_come = 0;
    for (const int v : order_.nodes) to_come += 1 + folding_.branch_weight[v];
    for (const int v : order_.nodes) {
      to_come -= 1 + folding_.branch_weight[v];
      if (!add(v, frontier, to_come)) return {};
      if (layers_.back().empty()) return {Decision::kInfeasible, {}};
    }
    return {Decision::kFeasible, read_back()};
  }

 private:
  bool add(int v, Numbers& frontier, int to_come) {
    step_.clear();
    next_.clear();
    Numbers nodes = frontier;
    nodes.push_back(v);
    std::vector<bool> stays(nodes.size());
    placed_.resize(g_.node.size(), false);
    placed_[v] = true;
    for (std::size_t s = 0; s < nodes.size(); ++s) {
      stays[s] =
          std::ranges::any_of(g_.neighbour[nodes[s]], [&](int w) { return w >= 0 && in_core_[w] && !placed_[w]; });
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

  // Tries all ways to join v to the blocks of its neighbours, with and without its branch.
  void expand(const State& state, int index, int v, const Numbers& frontier, const std::vector<bool>& stays,
              int to_come) {
    const FrontierBlocks blocks = unpack_blocks(state.key, frontier.size());
    std::array<int, 3> block_at{-1, -1, -1};  // Every block is listed at one side only.
    for (std::size_t s = 0; s < 3; ++s) {
      const auto position = std::ranges::find(frontier, g_.neighbour[v][s]);
      if (position == frontier.end()) continue;
      const int label = blocks.label[static_cast<std::size_t>(position - frontier.begin())];
      if (std::ranges::count(block_at, label) == 0) block_at[s] = label;
    }
    const int branch = folding_.branch_weight[v];
    for (unsigned joined = 0; joined < 8; ++joined) {
      int weight = 1;
      bool valid = true;
      for (std::size_t s = 0; s < 3; ++s) {
        if ((joined >> s & 1) == 0) continue;
        valid = valid && block_at[s] >= 0;
        if (valid) weight += blocks.weight[at(block_at[s])];
      }
      if (!valid || weight > capacity_) continue;
      if (weight + branch <= capacity_)
        commit({{}, state.closed, index, joined, true}, blocks, block_at, weight + branch, stays, to_come);
      if (branch > 0) commit({{}, state.closed + 1, index, joined, false}, blocks, block_at, weight, stays, to_come);
    }
  }

  void commit(State s, const FrontierBlocks& before, const std::array<int, 3>& block_at, int weight,
              const std::vector<bool>& stays, int to_come) {
    const NextFrontier next = next_frontier(before, s.joined, block_at, weight, stays);
    s.key = next.key;
    s.closed += next.closed;
    if (s.closed + (next.open_weight + to_come + capacity_ - 1) / capacity_ > k_) return;
    --budget_;
    const auto [found, is_new] = step_.try_emplace(s.key, static_cast<int>(next_.size()));
    if (is_new)
      next_.push_back(s);
    else if (s.closed < next_[found->second].closed)
      next_[found->second] = s;
  }

  Table<int, Numbers> read_back() const {
    DisjointSets sets(g_.node.size());
    Table<int, Numbers> parts = folding_.closed;
    Table<int, bool> keeps(g_.node.size(), true);
    const State* state = &layers_.back()[0];
    for (std::size_t layer = order_.nodes.size(); layer > 0; --layer) {
      const int v = order_.nodes[layer - 1];
      keeps[v] = state->keeps_branch;
      for (std::size_t s = 0; s < 3; ++s) {
        if ((state->joined >> s & 1) != 0) sets.join(v, g_.neighbour[v][s]);
      }
      state = &layers_[layer - 1][at(state->before)];
    }
    Numbers index(g_.node.size(), -1);
    for (const int v : order_.nodes) {
      const int top = sets.find(v);
      if (index[top] < 0) {
        index[top] = static_cast<int>(parts.size());
        parts.emplace_back();
      }
      const auto& branch = folding_.branch[v];
      parts[index[top]].push_back(v);
      if (keeps[v]) parts[index[top]].insert(parts[index[top]].end(), branch.begin(), branch.end());
    }
    for (const int v : order_.nodes) {
      if (!keeps[v]) parts.push_back(folding_.branch[v]);
    }
    return parts;
  }

  const LocalGraph& g_;
  const Folding& folding_;
  int capacity_, k_;
  long budget_;
  Table<int, bool> in_core_, placed_;
  FrontierOrder order_;
  Table<int, std::vector<State>> layers_;
  Table<int, State> next_;
  std::unordered_map<FrontierKey, int, FrontierKeyHash> step_;
};

}  // namespace

FrontierAnswer divide_exactly(const LocalGraph& g, const Folding& folding, int capacity, int k, long budget) {
  return FrontierProgramme(g, folding, capacity, k, budget).run();
}

}  // namespace triskin::routing

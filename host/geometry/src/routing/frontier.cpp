// SPDX-License-Identifier: GPL-3.0-or-later
#include "frontier.hpp"

#include <algorithm>
#include <unordered_map>

namespace triskin::geometry {
namespace {

constexpr int kMaxFrontier = 12;

// Position s of the frontier: 4 bits of `label` name its block, 5 bits of `weight` at the label hold the block's
// weight. Labels are numbered by first appearance, so equal situations have equal keys.
struct Key {
  std::uint64_t label = 0, weight = 0;
  bool operator==(const Key&) const = default;
};
struct KeyHash {
  std::size_t operator()(const Key& k) const {
    std::uint64_t h = k.label * 0x9E3779B97F4A7C15ULL ^ (k.weight + 0x7F4A7C15ULL) * 0xC2B2AE3D27D4EB4FULL;
    return static_cast<std::size_t>(h ^ (h >> 29));
  }
};
struct State {
  Key key;
  int closed = 0;
  int before = -1;      // state of the layer before
  unsigned joined = 0;  // sides over which the node joined its neighbour's part
  bool keeps_branch = true;
};

// The block of each frontier node and the weights, unpacked.
struct Blocks {
  std::array<int, kMaxFrontier + 1> label{};
  std::array<int, kMaxFrontier + 2> weight{};
};

class FrontierProgramme {
 public:
  FrontierProgramme(const LocalGraph& g, const Folding& folding, int capacity, int k, long budget)
      : g_(g),
        folding_(folding),
        capacity_(capacity),
        k_(k - static_cast<int>(folding.closed.size())),
        budget_(budget),
        in_core_(at(g.size()), false) {
    for (const int v : folding.core) in_core_[at(v)] = true;
    choose_order();
  }

  FrontierAnswer run() {
    if (widest_ > kMaxFrontier) return {};
    layers_.push_back({State{}});
    std::vector<int> frontier;
    int to_come = 0;
    for (const int v : order_) to_come += 1 + folding_.branch_weight[at(v)];
    for (const int v : order_) {
      to_come -= 1 + folding_.branch_weight[at(v)];
      if (!add(v, frontier, to_come)) return {};
      if (layers_.back().empty()) return {Decision::kInfeasible, {}};
    }
    return {Decision::kFeasible, read_back()};
  }

 private:
  // Grows the order from several starts; the next node is the one that leaves the smallest frontier.
  void choose_order() {
    const std::size_t step = std::max<std::size_t>(1, folding_.core.size() / 24);
    long best = -1;
    for (std::size_t s = 0; s < folding_.core.size(); s += step) {
      int widest = 0;
      long cost = 0;
      std::vector<int> order = grow(folding_.core[s], widest, cost);
      if (best < 0 || cost < best) {
        best = cost;
        order_ = std::move(order);
        widest_ = widest;
      }
    }
  }

  std::vector<int> grow(int start, int& widest, long& cost) const {
    std::vector<int> order, missing(at(g_.size()), 0), border{start};
    std::vector<bool> placed(at(g_.size()), false);
    for (const int v : folding_.core) {
      for (const int w : g_.neighbour[at(v)]) missing[at(v)] += w >= 0 && in_core_[at(w)] ? 1 : 0;
    }
    int frontier = 0;
    while (!border.empty()) {
      int best = 0, best_change = 9;
      for (std::size_t k = 0; k < border.size(); ++k) {
        int change = missing[at(border[k])] > 0 ? 1 : 0;
        for (const int w : g_.neighbour[at(border[k])])
          change -= w >= 0 && placed[at(w)] && missing[at(w)] == 1 ? 1 : 0;
        if (change < best_change) {
          best_change = change;
          best = static_cast<int>(k);
        }
      }
      const int v = border[at(best)];
      border.erase(border.begin() + best);
      placed[at(v)] = true;
      order.push_back(v);
      for (const int w : g_.neighbour[at(v)]) {
        if (w < 0 || !in_core_[at(w)]) continue;
        --missing[at(w)];
        if (!placed[at(w)] && std::ranges::count(border, w) == 0) border.push_back(w);
      }
      frontier += best_change;
      widest = std::max(widest, frontier + 1);
      cost += 1L << (2 * std::min(frontier, 20));
    }
    return order;
  }

  bool add(int v, std::vector<int>& frontier, int to_come) {
    step_.clear();
    next_.clear();
    std::vector<int> nodes = frontier;
    nodes.push_back(v);
    std::vector<bool> stays(nodes.size());
    placed_.resize(at(g_.size()), false);
    placed_[at(v)] = true;
    for (std::size_t s = 0; s < nodes.size(); ++s) {
      stays[s] = std::ranges::any_of(g_.neighbour[at(nodes[s])],
                                     [&](int w) { return w >= 0 && in_core_[at(w)] && !placed_[at(w)]; });
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

  static Blocks unpack(const Key& key, std::size_t n) {
    Blocks b;
    for (std::size_t s = 0; s < n; ++s) {
      b.label[s] = static_cast<int>(key.label >> (4 * s) & 15);
      b.weight[at(b.label[s])] = static_cast<int>(key.weight >> (5 * b.label[s]) & 31);
    }
    return b;
  }

  // All ways to join v to the blocks of its neighbours, with and without its branch.
  void expand(const State& state, int index, int v, const std::vector<int>& frontier, const std::vector<bool>& stays,
              int to_come) {
    const Blocks blocks = unpack(state.key, frontier.size());
    std::array<int, 3> block_at{-1, -1, -1};  // by side; each block once
    for (std::size_t s = 0; s < 3; ++s) {
      const auto position = std::ranges::find(frontier, g_.neighbour[at(v)][s]);
      if (position == frontier.end()) continue;
      const int label = blocks.label[static_cast<std::size_t>(position - frontier.begin())];
      if (std::ranges::count(block_at, label) == 0) block_at[s] = label;
    }
    const int branch = folding_.branch_weight[at(v)];
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

  void commit(State s, const Blocks& before, const std::array<int, 3>& block_at, int weight,
              const std::vector<bool>& stays, int to_come) {
    const std::size_t n = stays.size() - 1;
    std::array<int, kMaxFrontier + 2> renamed{};
    renamed.fill(-1);
    const int fresh = kMaxFrontier + 1;  // the block of v
    const auto old_block = [&](std::size_t position) {
      if (position == n) return fresh;
      for (std::size_t side = 0; side < 3; ++side) {
        if ((s.joined >> side & 1) != 0 && block_at[side] == before.label[position]) return fresh;
      }
      return before.label[position];
    };
    int blocks = 0, open = 0;
    std::size_t out = 0;
    for (std::size_t position = 0; position <= n; ++position) {
      if (!stays[position]) continue;
      const int b = old_block(position);
      if (renamed[at(b)] < 0) {
        renamed[at(b)] = blocks++;
        const int w = b == fresh ? weight : before.weight[at(b)];
        open += w;
        s.key.weight |= static_cast<std::uint64_t>(w) << (5 * renamed[at(b)]);
      }
      s.key.label |= static_cast<std::uint64_t>(renamed[at(b)]) << (4 * out++);
    }
    std::array<bool, kMaxFrontier + 2> counted{};
    for (std::size_t position = 0; position <= n; ++position) {
      const int b = old_block(position);
      if (renamed[at(b)] >= 0 || counted[at(b)]) continue;
      counted[at(b)] = true;
      ++s.closed;  // no node of this part has neighbours to come
    }
    if (s.closed + (open + to_come + capacity_ - 1) / capacity_ > k_) return;
    --budget_;
    const auto [found, is_new] = step_.try_emplace(s.key, static_cast<int>(next_.size()));
    if (is_new)
      next_.push_back(s);
    else if (s.closed < next_[at(found->second)].closed)
      next_[at(found->second)] = s;
  }

  std::vector<std::vector<int>> read_back() const {
    std::vector<int> leader(at(g_.size()), -1);
    const auto find = [&](int v) {
      while (leader[at(v)] != v) v = leader[at(v)];
      return v;
    };
    for (const int v : order_) leader[at(v)] = v;
    std::vector<std::vector<int>> parts = folding_.closed;
    std::vector<bool> keeps(at(g_.size()), true);
    const State* state = &layers_.back()[0];
    for (std::size_t layer = order_.size(); layer > 0; --layer) {
      const int v = order_[layer - 1];
      keeps[at(v)] = state->keeps_branch;
      for (std::size_t s = 0; s < 3; ++s) {
        if ((state->joined >> s & 1) != 0) leader[at(find(v))] = find(g_.neighbour[at(v)][s]);
      }
      state = &layers_[layer - 1][at(state->before)];
    }
    std::vector<int> index(at(g_.size()), -1);
    for (const int v : order_) {
      const int top = find(v);
      if (index[at(top)] < 0) {
        index[at(top)] = static_cast<int>(parts.size());
        parts.emplace_back();
      }
      const auto& branch = folding_.branch[at(v)];
      parts[at(index[at(top)])].push_back(v);
      if (keeps[at(v)]) parts[at(index[at(top)])].insert(parts[at(index[at(top)])].end(), branch.begin(), branch.end());
    }
    for (const int v : order_) {
      if (!keeps[at(v)]) parts.push_back(folding_.branch[at(v)]);
    }
    return parts;
  }

  const LocalGraph& g_;
  const Folding& folding_;
  int capacity_, k_;
  long budget_;
  std::vector<bool> in_core_, placed_;
  std::vector<int> order_;
  int widest_ = 0;
  std::vector<std::vector<State>> layers_;
  std::vector<State> next_;
  std::unordered_map<Key, int, KeyHash> step_;
};

}  // namespace

FrontierAnswer divide_exactly(const LocalGraph& g, const Folding& folding, int capacity, int k, long budget) {
  return FrontierProgramme(g, folding, capacity, k, budget).run();
}

}  // namespace triskin::geometry

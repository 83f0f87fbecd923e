// SPDX-License-Identifier: GPL-3.0-or-later
#include "jumper_frontier.hpp"

#include <algorithm>
#include <unordered_map>

namespace triskin::geometry {
namespace {

constexpr int kMaxFrontier = 12;

// As in frontier.cpp: 4 bits a frontier node name its block, 5 bits a block hold its weight.
struct Key {
  std::uint64_t label = 0, weight = 0;
  bool operator==(const Key&) const = default;
};
struct KeyHash {
  std::size_t operator()(const Key& k) const {
    const std::uint64_t h = k.label * 0x9E3779B97F4A7C15ULL ^ (k.weight + 0x7F4A7C15ULL) * 0xC2B2AE3D27D4EB4FULL;
    return static_cast<std::size_t>(h ^ (h >> 29));
  }
};
struct State {
  Key key;
  std::int64_t cost = 0;  // of closed parts and of jumpers
  int before = -1;
  unsigned joined = 0;  // sides over which the node joined its neighbour's part
};
struct Blocks {
  std::array<int, kMaxFrontier + 1> label{};
  std::array<int, kMaxFrontier + 2> weight{};
};

class CheapestPartition {
 public:
  CheapestPartition(const JumperGraph& g, int capacity, const IntegerPrice& price, std::int64_t limit, long budget)
      : graph_(g), g_(g.joined), capacity_(capacity), price_(price), limit_(limit), budget_(budget) {
    choose_order();
  }

  CheapestParts run() {
    if (widest_ > kMaxFrontier) return {};
    layers_.push_back({State{}});
    std::vector<int> frontier;
    int to_come = g_.size();
    for (const int v : order_) {
      if (!add(v, frontier, --to_come)) return {};
      if (layers_.back().empty()) return {true, {}, 0};
    }
    return read_back();
  }

 private:
  void choose_order() {
    const int step = std::max(1, g_.size() / 24);
    long best = -1;
    for (int s = 0; s < g_.size(); s += step) {
      int widest = 0;
      long cost = 0;
      std::vector<int> order = grow(s, widest, cost);
      if (best >= 0 && cost >= best) continue;
      best = cost;
      order_ = std::move(order);
      widest_ = widest;
    }
  }

  // The next node is the one that leaves the smallest frontier.
  [[nodiscard]] std::vector<int> grow(int start, int& widest, long& cost) const {
    std::vector<int> order, missing(at(g_.size()), 0), border{start};
    std::vector<bool> placed(at(g_.size()), false);
    for (int v = 0; v < g_.size(); ++v)
      missing[at(v)] = static_cast<int>(std::ranges::count_if(g_.neighbour[at(v)], [](int w) { return w >= 0; }));
    int frontier = 0;
    while (!border.empty()) {
      std::pair<int, std::size_t> best{9, 0};
      for (std::size_t k = 0; k < border.size(); ++k) {
        int change = missing[at(border[k])] > 0 ? 1 : 0;
        for (const int w : g_.neighbour[at(border[k])])
          change -= w >= 0 && placed[at(w)] && missing[at(w)] == 1 ? 1 : 0;
        best = std::min(best, {change, k});
      }
      const int v = border[best.second];
      border.erase(border.begin() + static_cast<std::ptrdiff_t>(best.second));
      placed[at(v)] = true;
      order.push_back(v);
      for (const int w : g_.neighbour[at(v)]) {
        if (w < 0) continue;
        --missing[at(w)];
        if (!placed[at(w)] && std::ranges::count(border, w) == 0) border.push_back(w);
      }
      frontier += best.first;
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

  static Blocks unpack(const Key& key, std::size_t n) {
    Blocks b;
    for (std::size_t s = 0; s < n; ++s) {
      b.label[s] = static_cast<int>(key.label >> (4 * s) & 15);
      b.weight[at(b.label[s])] = static_cast<int>(key.weight >> (5 * b.label[s]) & 31);
    }
    return b;
  }

  // All ways to join v to the blocks of its neighbours; to a block that a joint and a jumper lead to, over the joint.
  void expand(const State& state, int index, int v, const std::vector<int>& frontier, const std::vector<bool>& stays,
              int to_come) {
    const Blocks blocks = unpack(state.key, frontier.size());
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

  void commit(State s, const Blocks& before, const std::array<int, 3>& block_at, int weight,
              const std::vector<bool>& stays, int to_come) {
    const std::size_t n = stays.size() - 1;
    std::array<int, kMaxFrontier + 2> renamed{};
    renamed.fill(-1);
    const int fresh = kMaxFrontier + 1;  // the block of v
    const auto block_of = [&](std::size_t position) {
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
      const int b = block_of(position);
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
      const int b = block_of(position);
      if (renamed[at(b)] >= 0 || counted[at(b)]) continue;
      counted[at(b)] = true;
      s.cost += price_.part;  // no node of this part has neighbours to come
    }
    if (s.cost + price_.part * ((open + to_come + capacity_ - 1) / capacity_) >= limit_) return;
    --budget_;
    const auto [found, is_new] = step_.try_emplace(s.key, static_cast<int>(next_.size()));
    if (is_new)
      next_.push_back(s);
    else if (s.cost < next_[at(found->second)].cost)
      next_[at(found->second)] = s;
  }

  [[nodiscard]] CheapestParts read_back() const {
    std::vector<int> leader(at(g_.size()));
    for (int v = 0; v < g_.size(); ++v) leader[at(v)] = v;
    const auto find = [&](int v) {
      while (leader[at(v)] != v) v = leader[at(v)];
      return v;
    };
    const State* state = &layers_.back()[0];
    for (std::size_t layer = order_.size(); layer > 0; --layer) {
      const int v = order_[layer - 1];
      for (std::size_t s = 0; s < 3; ++s) {
        if ((state->joined >> s & 1) != 0) leader[at(find(v))] = find(g_.neighbour[at(v)][s]);
      }
      state = &layers_[layer - 1][at(state->before)];
    }
    CheapestParts answer{true, std::vector<int>(at(g_.size()), -1), 0};
    std::vector<int> number(at(g_.size()), -1);
    for (int v = 0; v < g_.size(); ++v) {
      int& part = number[at(find(v))];
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
  std::vector<int> order_;
  int widest_ = 0;
  std::vector<std::vector<State>> layers_;
  std::vector<State> next_;
  std::unordered_map<Key, int, KeyHash> step_;
};

}  // namespace

CheapestParts cheapest_parts(const JumperGraph& g, int capacity, const IntegerPrice& price, std::int64_t limit,
                             long budget) {
  return CheapestPartition(g, capacity, price, limit, budget).run();
}

}  // namespace triskin::geometry

// SPDX-License-Identifier: GPL-3.0-or-later
#include "jumper_frontier.hpp"

#include <algorithm>
#include <bit>
#include <unordered_map>

#include "jumper_state.hpp"
#include "triskin/base/disjoint_sets.hpp"

namespace triskin::routing {
namespace {

constexpr int kStarts = 24;    // We try this many orders of the nodes.
constexpr int kMaxUnits = 40;  // The cost of an order is a power of two, and this caps the exponent.

// Weighs slots in the choice of an order; jumpers count less than joints since most of them are not fitted.
struct SlotUnits {
  int joint, jumper;
};

struct NodeOrder {
  Numbers nodes;
  long cost = 0;
  int reached = 0;  // This many nodes were placed before the budget ended.
};

// Builds an order of the nodes from each of some starts that keeps the slots few: the next node is the one after which
// they are fewest.
class SlotOrder {
 public:
  SlotOrder(const JumperGraph& g, SlotUnits units) : g_(g), units_(units) {}

  NodeOrder from(int start) {
    NodeOrder order;
    int units = 0;
    Numbers border{start};
    placed_.assign(g_.joined.node.size(), false);
    while (!border.empty()) {
      std::pair<int, std::size_t> next{1 << 20, 0};
      for (std::size_t k = 0; k < border.size(); ++k) next = std::min(next, {change(border[k]), k});
      const int v = border[next.second];
      border.erase(border.begin() + static_cast<std::ptrdiff_t>(next.second));
      placed_[v] = true;
      order.nodes.push_back(v);
      units += next.first;
      order.cost += 1L << std::min(units, kMaxUnits);
      for (const int w : g_.joined.neighbour[v]) {
        if (w >= 0 && !placed_[w] && std::ranges::count(border, w) == 0) border.push_back(w);
      }
    }
    return order;
  }

 private:
  // Returns the change of the units of all slots when v is placed.
  [[nodiscard]] int change(int v) const {
    int units = 0;
    bool stays = false;
    for (std::size_t s = 0; s < 3; ++s) {
      const int w = g_.joined.neighbour[v][s];
      if (w < 0) continue;
      if (g_.over_jumper[v][s]) {
        units += placed_[w] ? -units_.jumper : units_.jumper;
      } else if (!placed_[w]) {
        stays = true;
      } else {
        int to_come = 0;
        for (const int u : g_.apart.neighbour[w]) to_come += u >= 0 && !placed_[u] ? 1 : 0;
        if (to_come == 1) units -= units_.joint;
      }
    }
    return units + (stays ? units_.joint : 0);
  }

  const JumperGraph& g_;
  SlotUnits units_;
  Table<int, bool> placed_;
};

struct Slot {
  int node, side;  // Side −1 means that it spans all joints.
};

// Tells how a node meets the slots, which is the same for all states of a layer.
struct Step {
  // These are the slots of placed neighbours at each side.
  Triple<int> over_joint{-1, -1, -1}, over_jumper{-1, -1, -1};
  Numbers kept;  // These slots of the previous layer remain.
  std::vector<bool> kept_is_jumper;
  bool stays = false;       // The node itself becomes a slot.
  int new_jumpers = 0;      // Jumpers to later nodes become slots, too.
  int islands_to_come = 0;  // These islands have no placed node yet.
  bool between = false;     // Every other island is placed already.
};

// One way to join a node to the blocks of its neighbours.
struct Choice {
  unsigned sides = 0, blocks = 0, fitted = 0;  // All are bit sets; `fitted` holds the new jumpers.
  int weight = 1;
};

class CheapestPartition {
 public:
  CheapestPartition(const JumperGraph& g, int capacity, const IntegerPrice& price, std::int64_t limit, long budget,
                    NodeOrder& order)
      : graph_(g),
        g_(g.joined),
        capacity_(capacity),
        price_(price),
        limit_(limit),
        budget_(budget),
        to_come_(g.joined.size()),
        placed_(g.joined.node.size(), false),
        island_of_(g.joined.node.size()),
        order_(order) {
    order.reached = 0;
    for (const Numbers& island : components(g.apart)) {
      for (const int v : island) island_of_[v] = static_cast<int>(island_size_.size());
      island_size_.push_back(static_cast<int>(island.size()));
    }
    left_of_island_ = island_size_;
  }

  CheapestParts run() {
    layers_.push_back({JumperState{}});
    for (const int v : order_.nodes) {
      if (!add(v)) return {};
      ++order_.reached;
      if (layers_.back().empty()) return {true, {}, 0};
    }
    return read_back();
  }
  [[nodiscard]] long budget() const { return budget_; }

 private:
  bool add(int v) {
    const Step step = prepare(v);
    if (slots_.size() > at(kMaxSlots)) return false;
    buckets_.clear();
    lists_.clear();
    const std::vector<JumperState>& now = layers_.back();
    for (std::size_t i = 0; i < now.size(); ++i) {
      if ((budget_ -= 4) < 0 || too_many_blocks_) return false;
      expand(now[i], static_cast<int>(i), step);
    }
    std::vector<JumperState> next;
    for (const auto& list : lists_) next.insert(next.end(), list.begin(), list.end());
    layers_.push_back(std::move(next));
    return true;
  }

  Step prepare(int v) {
    placed_[v] = true;
    --to_come_;
    Step step;
    std::vector<Slot> next;
    for (std::size_t k = 0; k < slots_.size(); ++k) {
      const Slot& s = slots_[k];
      const bool is_jumper = s.side >= 0, ends = is_jumper && g_.neighbour[s.node][s.side] == v;
      for (std::size_t side = 0; side < 3; ++side) {
        if (g_.neighbour[v][side] != s.node) continue;
        if (ends) step.over_jumper[side] = static_cast<int>(k);
        if (!is_jumper && !graph_.over_jumper[v][side]) step.over_joint[side] = static_cast<int>(k);
      }
      if (ends || (!is_jumper && !has_joint_to_come(s.node))) continue;
      step.kept.push_back(static_cast<int>(k));
      step.kept_is_jumper.push_back(is_jumper);
      next.push_back(s);
    }
    step.stays = has_joint_to_come(v);
    if (step.stays) next.push_back({v, -1});
    for (int side = 0; side < 3; ++side) {
      if (!graph_.over_jumper[v][side] || placed_[g_.neighbour[v][side]]) continue;
      ++step.new_jumpers;
      next.push_back({v, side});
    }
    slots_ = std::move(next);
    count_islands(v, step);
    return step;
  }
  void count_islands(int v, Step& step) {
    --left_of_island_[island_of_[v]];
    int started = 0;
    for (std::size_t k = 0; k < island_size_.size(); ++k) {
      step.islands_to_come += left_of_island_[k] == island_size_[k] ? 1 : 0;
      started += left_of_island_[k] > 0 && left_of_island_[k] < island_size_[k] ? 1 : 0;
    }
    step.between = started == 0 && step.islands_to_come > 0;
  }
  [[nodiscard]] bool has_joint_to_come(int v) const {
    return std::ranges::any_of(graph_.apart.neighbour[v], [&](int w) { return w >= 0 && !placed_[w]; });
  }

  // Tries all ways to join the node; jumpers that were fitted for it must be used.
  void expand(const JumperState& state, int index, const Step& step) {
    Choice forced;
    for (std::size_t s = 0; s < 3; ++s) {
      const int b = step.over_jumper[s] < 0 ? kNoBlock : state.labels.get(step.over_jumper[s]);
      if (b == kNoBlock) continue;
      if ((forced.blocks >> b & 1) != 0) return;  // A single jumper to the block is enough.
      join(state, s, b, forced);
    }
    std::array<int, 3> offered{kNoBlock, kNoBlock, kNoBlock};  // Every block is listed at one side only.
    for (std::size_t s = 0; s < 3; ++s) {
      const int b = step.over_joint[s] < 0 ? kNoBlock : state.labels.get(step.over_joint[s]);
      if (b == kNoBlock || std::ranges::count(offered, b) > 0) continue;
      if ((forced.blocks >> b & 1) != 0) return;  // The joint already connects the block.
      offered[s] = b;
    }
    for (unsigned sides = 0; sides < 8; ++sides) {
      Choice choice = forced;
      bool valid = true;
      for (std::size_t s = 0; s < 3 && valid; ++s) {
        if ((sides >> s & 1) == 0) continue;
        valid = offered[s] != kNoBlock;
        if (valid) join(state, s, offered[s], choice);
      }
      if (!valid || choice.weight > capacity_) continue;
      for (choice.fitted = 0; choice.fitted >> step.new_jumpers == 0; ++choice.fitted)
        commit(state, index, step, choice);
    }
  }
  static void join(const JumperState& state, std::size_t side, int block, Choice& choice) {
    choice.sides |= 1U << side;
    choice.blocks |= 1U << block;
    choice.weight += state.weight(block);
  }

  // A full part is closed at once, so its slots belong to no block.
  void commit(const JumperState& before, int index, const Step& step, const Choice& choice) {
    JumperState s;
    s.before = index;
    s.joined = static_cast<std::uint8_t>(choice.sides);
    const bool full = choice.weight == capacity_;
    const int fresh = kMaxBlocks;  // The node's block has this number.
    std::array<int, kMaxBlocks + 1> renamed{};
    renamed.fill(-1);
    // All but slot and weight count jumpers.
    int slot = 0, open_weight = 0, mine_open = std::popcount(choice.fitted), open = mine_open;
    const auto label = [&](int b) {
      if (b == kNoBlock || (b == fresh && full)) return s.labels.set(slot++, kNoBlock);
      if (renamed[at(b)] < 0) {
        renamed[at(b)] = s.blocks++;
        const int w = b == fresh ? choice.weight : before.weight(b);
        open_weight += w;
        if (s.blocks <= kMaxBlocks) s.weights |= static_cast<std::uint64_t>(w) << (5 * renamed[at(b)]);
      }
      s.labels.set(slot++, renamed[at(b)]);
    };
    for (std::size_t k = 0; k < step.kept.size(); ++k) {
      const int b = before.labels.get(step.kept[k]);
      const bool mine = b != kNoBlock && (choice.blocks >> b & 1) != 0;
      if (step.kept_is_jumper[k]) {
        open += b != kNoBlock ? 1 : 0;
        mine_open += mine ? 1 : 0;
      }
      label(mine ? fresh : b);
    }
    if (choice.weight + mine_open > capacity_) return;  // The modules behind the jumpers would have no place.
    if (step.between && open == 0) return;              // Nothing could then join the later islands.
    if (step.stays) label(fresh);
    for (int k = 0; k < step.new_jumpers; ++k) label((choice.fitted >> k & 1) != 0 ? fresh : kNoBlock);
    int closed = renamed[fresh] < 0 ? 1 : 0;
    for (int b = 0; b < before.blocks; ++b) closed += (choice.blocks >> b & 1) == 0 && renamed[at(b)] < 0 ? 1 : 0;
    s.cost = before.cost + price_.part * closed + price_.jumper * std::popcount(choice.fitted);
    const int parts_to_come = (open_weight + to_come_ + capacity_ - 1) / capacity_;
    if (s.cost + price_.of(parts_to_come, std::max(0, step.islands_to_come - open)) >= limit_) return;
    too_many_blocks_ = too_many_blocks_ || s.blocks > kMaxBlocks;
    keep(s);
  }

  // Keeps only states that no state with equal labels beats.
  void keep(const JumperState& s) {
    --budget_;
    const auto [found, is_new] = buckets_.try_emplace(s.labels, static_cast<int>(lists_.size()));
    if (is_new) return lists_.push_back({s});
    auto& list = lists_[found->second];
    budget_ -= static_cast<long>(list.size() / 16);
    if (std::ranges::any_of(list, [&](const JumperState& other) { return other.beats(s); })) return;
    std::erase_if(list, [&](const JumperState& other) { return s.beats(other); });
    list.push_back(s);
  }

  [[nodiscard]] CheapestParts read_back() const {
    DisjointSets sets(g_.node.size());
    const JumperState* state = &layers_.back()[0];
    for (std::size_t layer = order_.nodes.size(); layer > 0; --layer) {
      const int v = order_.nodes[layer - 1];
      for (std::size_t s = 0; s < 3; ++s) {
        if ((state->joined >> s & 1) != 0) sets.join(v, g_.neighbour[v][s]);
      }
      state = &layers_[layer - 1][at(state->before)];
    }
    CheapestParts answer{true, Numbers(g_.node.size(), -1), 0};
    Numbers number(g_.node.size(), -1);
    for (int v = 0; v < g_.size(); ++v) {
      int& part = number[sets.find(v)];
      if (part < 0) part = answer.parts++;
      answer.part_of[v] = part;
    }
    return answer;
  }

  const JumperGraph& graph_;
  const LocalGraph& g_;
  int capacity_;
  const IntegerPrice& price_;
  std::int64_t limit_;
  long budget_;
  int to_come_;
  bool too_many_blocks_ = false;
  Table<int, bool> placed_;
  Numbers island_of_, island_size_, left_of_island_;
  NodeOrder& order_;
  std::vector<Slot> slots_;
  Table<int, std::vector<JumperState>> layers_;
  std::unordered_map<SlotLabels, int, SlotLabelsHash> buckets_;
  Table<int, std::vector<JumperState>> lists_;
};

}  // namespace

// Only a trial shows which order is good: all get a small budget, and those that got far a larger one.
CheapestParts cheapest_parts(const JumperGraph& g, int capacity, const IntegerPrice& price, std::int64_t limit,
                             long& budget) {
  Table<int, NodeOrder> orders;
  const int n = g.joined.size(), step = std::max(1, n / kStarts);
  for (const SlotUnits units : {SlotUnits{2, 1}, SlotUnits{1, 1}}) {
    SlotOrder order(g, units);
    for (int start = 0; start < n; start += step) orders.push_back(order.from(start));
  }
  std::ranges::stable_sort(orders, {}, &NodeOrder::cost);
  const long whole = budget;
  for (const auto& [tried, share] : {std::pair{48, 128}, std::pair{6, 12}, std::pair{1, 1}}) {
    for (int k = 0; k < std::min(tried, static_cast<int>(orders.size())) && budget > 0; ++k) {
      const long granted = std::min(budget, whole / share);
      CheapestPartition programme(g, capacity, price, limit, granted, orders[k]);
      CheapestParts answer = programme.run();
      budget -= granted - std::max(0L, programme.budget());
      if (answer.decided) return answer;
    }
    std::ranges::stable_sort(orders, std::ranges::greater{}, &NodeOrder::reached);
  }
  return {};
}

}  // namespace triskin::routing

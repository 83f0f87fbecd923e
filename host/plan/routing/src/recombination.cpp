// SPDX-License-Identifier: GPL-3.0-or-later
#include "recombination.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "wiring.hpp"

namespace triskin::routing {
namespace {

constexpr int kJumper = 1'000'000, kNoBorder = 20'000, kLost = 24, kDepth = 3;
constexpr int kFirstThreshold = 120;
constexpr int kExchanges = 8;  // This many single modules are tried for each pair of parts.

std::uint32_t bit(int v) {
  return 1U << v;
}
int lowest(std::uint32_t set) {
  return std::countr_zero(set);
}

// Returns one bit of `set` at random.
int pick(std::uint32_t set, Dice& random) {
  for (int k = random.below(std::popcount(set)); k > 0; --k) set &= set - 1;
  return lowest(set);
}

class Recombiner {
 public:
  Recombiner(const ModuleGraph& graph, const LocalGraph& g, const RoutingOptions& options, Dice& random,
             Partition& partition, const Table<int, Triple<bool>>* over_jumper)
      : g_(g),
        over_jumper_(over_jumper),
        capacity_(options.capacity),
        random_(random),
        p_(partition),
        members_(at(partition.parts)),
        cost_(at(partition.parts)),
        border_(g.node.size(), false),
        cable_cm_(g.node.size(), 0),
        slot_(g.node.size(), -1) {
    for (int v = 0; v < g.size(); ++v) {
      members_[p_.part_of[v]].push_back(v);
      for (int s = 0; s < 3; ++s) border_[v] = border_[v] || is_border(graph, g.node[v], s);
      if (options.has_controller_place)
        cable_cm_[v] = static_cast<int>(std::lround(cable_m(graph, g.node[v], options) * 100.0));
    }
    for (std::size_t k = 0; k < members_.size(); ++k) {
      load(members_[k], {});
      cost_[k] = secondary_cost(bits(), around_, bits().all);
    }
    for (int v = 0; v < g.size(); ++v) {
      for (const int w : g.neighbour[v]) {
        if (w >= 0) joints_.push_back({v, w});
      }
    }
  }

  void run(int moves) {
    // The second half only descends, so the result is a local optimum of the visited divisions.
    for (int k = 0; k < moves; ++k) move(std::max(0, kFirstThreshold - 2 * kFirstThreshold * k / moves));
  }

 private:
  [[nodiscard]] const PartBits& bits() const { return *bits_; }

  // Loads the union of two parts as local numbers 0 … n−1; the first part's nodes come first.
  void load(const Numbers& a, const Numbers& b) {
    both_.node = a;
    both_.node.insert(both_.node.end(), b.begin(), b.end());
    both_.neighbour.assign(both_.node.size(), {-1, -1, -1});
    around_.border = 0;
    for (std::size_t k = 0; k < both_.node.size(); ++k) slot_[both_.node[k]] = static_cast<int>(k);
    for (std::size_t k = 0; k < both_.node.size(); ++k) {
      const int v = both_.node[k];
      for (std::size_t s = 0; s < 3; ++s)
        both_.neighbour[k][s] = g_.neighbour[v][s] < 0 ? -1 : slot_[g_.neighbour[v][s]];
      if (border_[v]) around_.border |= 1U << k;
      if (over_jumper_ != nullptr) mark_jumpers(k);
      around_.cable_cm[k] = cable_cm_[v];
    }
    for (const int v : both_.node) slot_[v] = -1;
    bits_.emplace(both_);
  }

  void mark_jumpers(std::size_t k) {
    around_.jumpers = true;
    around_.over_jumper[k] = 0;
    for (std::size_t s = 0; s < 3; ++s) {
      const int w = both_.neighbour[k][s];
      if (w >= 0 && (*over_jumper_)[at(both_.node[k])][s]) around_.over_jumper[k] |= bit(w);
    }
  }

  void move(int threshold) {
    int a = 0, b = 0;
    for (int tries = 0; tries < 64 && a == b && !joints_.empty(); ++tries) {
      const auto& [v, w] = joints_[random_.below(static_cast<int>(joints_.size()))];
      a = p_.part_of[v];
      b = p_.part_of[w];
    }
    if (a == b) return;
    load(members_[a], members_[b]);
    first_ = members_[a].size() == 32 ? ~0U : (1U << members_[a].size()) - 1U;
    now_ = cost_[a] + cost_[b];
    const std::uint32_t before = first_;
    if (random_.below(3) == 0) cut_a_tree(threshold);
    for (int k = 0; k < kExchanges; ++k) exchange(threshold);
    if (first_ != before) store(a, b);
  }

  void offer(std::uint32_t first, int threshold) {
    const int cost = secondary_cost(bits(), around_, first) + secondary_cost(bits(), around_, bits().all & ~first);
    if (cost > now_ + threshold) return;
    now_ = cost;
    first_ = first;
  }

  // Returns the nodes of `set` beside `other`.
  [[nodiscard]] std::uint32_t rim(std::uint32_t set, std::uint32_t other) const {
    std::uint32_t touched = 0;
    for (; other != 0; other &= other - 1) touched |= bits().joined[at(lowest(other))];
    return touched & set;
  }

  // Moves one module across, or swaps two if a part is full.
  void exchange(int threshold) {
    const std::uint32_t second = bits().all & ~first_;
    const std::uint32_t rim_first = rim(first_, second), rim_second = rim(second, first_);
    if (rim_first == 0 || rim_second == 0) return;
    std::uint32_t changed = first_;
    const int style = random_.below(4);
    if (style != 0) changed &= ~bit(pick(rim_first, random_));
    if (style != 1) changed |= bit(pick(rim_second, random_));
    const std::uint32_t rest = bits().all & ~changed;
    if (std::popcount(changed) > capacity_ || std::popcount(rest) > capacity_) return;
    if (!bits().connected(changed) || !bits().connected(rest)) return;
    offer(changed, threshold);
  }

  void cut_a_tree(int threshold) {
    const Numbers whole(both_.node.size(), 0);
    random_tree(both_, whole, 0, random_.below(both_.size()), random_, tree_);
    std::array<std::uint32_t, 32> below{};
    Numbers fits;
    for (auto v = tree_.order.rbegin(); v != tree_.order.rend(); ++v) {
      below[at(*v)] |= bit(*v);
      const int p = tree_.parent[*v], size = std::popcount(below[at(*v)]);
      if (p < 0) continue;
      below[at(p)] |= below[at(*v)];
      if (size <= capacity_ && both_.size() - size <= capacity_) fits.push_back(*v);
    }
    if (!fits.empty()) offer(below[at(fits[random_.below(static_cast<int>(fits.size()))])], threshold);
  }

  void store(int a, int b) {
    members_[a].clear();
    members_[b].clear();
    for (int k = 0; k < both_.size(); ++k) {
      const int part = (first_ & bit(k)) != 0 ? a : b;
      members_[part].push_back(both_.node[k]);
      p_.part_of[both_.node[k]] = part;
    }
    cost_[a] = secondary_cost(bits(), around_, first_);
    cost_[b] = now_ - cost_[a];
  }

  const LocalGraph& g_;
  const Table<int, Triple<bool>>* over_jumper_;
  int capacity_;
  Dice& random_;
  Partition& p_;
  Table<int, Numbers> members_;
  Numbers cost_;
  Table<int, bool> border_;
  Numbers cable_cm_, slot_;
  Table<int, std::array<int, 2>> joints_;
  LocalGraph both_;
  std::optional<PartBits> bits_;
  PartSurroundings around_;
  SpanningTree tree_;
  std::uint32_t first_ = 0;
  int now_ = 0;
};

// Returns how many jumpers hold a part together: its pieces without them, less one.
int jumpers_within(const PartBits& bits, const PartSurroundings& around, std::uint32_t part) {
  int pieces = 0;
  for (std::uint32_t rest = part; rest != 0; ++pieces) {
    std::uint32_t seen = rest & (~rest + 1), front = seen;
    while (front != 0) {
      std::uint32_t next = 0;
      for (; front != 0; front &= front - 1)
        next |= bits.joined[at(lowest(front))] & ~around.over_jumper[at(lowest(front))];
      front = next & part & ~seen;
      seen |= front;
    }
    rest &= ~seen;
  }
  return pieces - 1;
}

// Returns the modules lost beyond the failed one, over all single module failures, with `entry` and the best second
// entry.
int lost_with_two_entries(const PartBits& bits, std::uint32_t part, int entry) {
  std::array<std::uint32_t, 64> pieces;  // Without the entry, the part falls into these pieces.
  std::size_t count = 0;
  for (std::uint32_t left = part; left != 0; left &= left - 1) {
    std::uint32_t rest = part & ~(left & (~left + 1));
    if (lowest(left) != entry) rest &= ~bits.reach(bit(entry), rest);
    while (rest != 0 && count < pieces.size()) {
      pieces[count] = bits.reach(rest & (~rest + 1), rest);
      rest &= ~pieces[count++];
    }
  }
  int all = 0;
  for (std::size_t k = 0; k < count; ++k) all += std::popcount(pieces[k]);
  int best = all;
  if (count == 0) return 0;
  for (std::uint32_t seconds = part & ~bit(entry); seconds != 0; seconds &= seconds - 1) {
    if (std::popcount(bits.joined[at(lowest(seconds))] & part) == 3) continue;  // No side remains for a connector.
    const std::uint32_t second = seconds & (~seconds + 1);
    int lost = all;
    for (std::size_t k = 0; k < count; ++k) lost -= (pieces[k] & second) != 0 ? std::popcount(pieces[k]) : 0;
    best = std::min(best, lost);
  }
  return best;
}

}  // namespace

int secondary_cost(const PartBits& bits, const PartSurroundings& around, std::uint32_t part) {
  const bool on_border = (around.border & part) != 0;
  int best = -1, entry = lowest(part);
  for (std::uint32_t places = on_border ? around.border & part : part; places != 0; places &= places - 1) {
    const int v = lowest(places);
    const int cost = kDepth * bits.sum_of_distances(v, part) + around.cable_cm[at(v)];
    if (best >= 0 && cost >= best) continue;
    best = cost;
    entry = v;
  }
  const int jumpers = around.jumpers ? kJumper * jumpers_within(bits, around, part) : 0;
  return jumpers + (on_border ? 0 : kNoBorder) + kLost * lost_with_two_entries(bits, part, entry) + best;
}

void recombine(const ModuleGraph& graph, const LocalGraph& g, const RoutingOptions& options, int moves, Dice& random,
               Partition& partition, const Table<int, Triple<bool>>* over_jumper) {
  if (partition.parts < 2) return;
  Recombiner(graph, g, options, random, partition, over_jumper).run(moves);
}

}  // namespace triskin::routing

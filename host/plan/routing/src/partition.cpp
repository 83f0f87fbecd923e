// SPDX-License-Identifier: GPL-3.0-or-later
#include "partition.hpp"

#include <algorithm>

#include "frontier.hpp"

namespace triskin::routing {
namespace {

constexpr int kTrees = 24;
constexpr long kPeelBudget = 1'000'000;   // The budget counts node visits, which take about 15 ms.
constexpr long kExactBudget = 2'000'000;  // The budget counts state transitions, which take about 0.3 s.

class Partitioner {
 public:
  Partitioner(const LocalGraph& g, int capacity, std::uint64_t seed, const std::function<bool()>& give_up)
      : g_(g), capacity_(capacity), give_up_(give_up), random_(seed), whole_(g.node.size(), 0) {}

  Partition run() {
    const int by_size = (g_.size() + capacity_ - 1) / capacity_;
    best_.lower_bound = folded_lower_bound(g_, whole_, 0, capacity_);
    best_.proof = best_.lower_bound == by_size ? PartitionProof::kSize : PartitionProof::kFolding;
    try_trees();
    if (!is_done()) try_peel(kPeelBudget + 60L * g_.size());
    if (!is_done()) try_exact();
    if (!met()) best_.proof = PartitionProof::kOpen;
    return std::move(best_);
  }

 private:
  [[nodiscard]] bool met() const { return best_.parts == best_.lower_bound; }
  [[nodiscard]] bool is_done() const { return met() || (give_up_ && give_up_()); }

  void offer(const Numbers& part_of, int parts) {
    if (best_.parts > 0 && parts >= best_.parts) return;
    best_.part_of = part_of;
    best_.parts = parts;
  }
  void offer(const Table<int, Numbers>& parts) {
    Numbers part_of(g_.node.size(), -1);
    for (std::size_t p = 0; p < parts.size(); ++p) {
      for (const int v : parts[p]) part_of[v] = static_cast<int>(p);
    }
    offer(part_of, static_cast<int>(parts.size()));
  }

  void try_trees() {
    SpanningTree tree;
    Numbers part_of;
    for (int k = 0; k < kTrees && (k == 0 || !is_done()); ++k) {
      random_tree(g_, whole_, 0, random_.below(g_.size()), random_, tree);
      const int parts = cut_tree(g_, tree, capacity_, part_of);
      offer(part_of, parts);
    }
  }

  // Tries downwards from the best, so that a large patch that misses the bound still ends near it.
  void try_peel(long budget) {
    Numbers part_of;
    if (peel(g_, capacity_, best_.lower_bound, budget, random_, part_of)) return offer(part_of, best_.lower_bound);
    while (best_.parts > best_.lower_bound + 1 && !is_done() &&
           peel(g_, capacity_, best_.parts - 1, budget / 2, random_, part_of)) {
      offer(part_of, best_.parts - 1);
    }
  }

  void try_exact() {
    const Folding folding = fold(g_, whole_, 0, capacity_);
    while (!met()) {
      const FrontierAnswer answer = divide_exactly(g_, folding, capacity_, best_.lower_bound, kExactBudget);
      if (answer.decision == Decision::kTooLarge) return;
      if (answer.decision == Decision::kFeasible)
        offer(answer.parts);
      else
        ++best_.lower_bound;
      best_.proof = PartitionProof::kFrontier;
    }
  }

  const LocalGraph& g_;
  int capacity_;
  const std::function<bool()>& give_up_;
  Dice random_;
  Numbers whole_;
  Partition best_;
};

}  // namespace

int cut_tree(const LocalGraph& g, const SpanningTree& tree, int capacity, Numbers& part_of) {
  Numbers weight(g.node.size(), 1);
  Table<int, Triple<int>> children(g.node.size(), {-1, -1, -1});
  Numbers count(g.node.size(), 0);
  Table<int, bool> is_root(g.node.size(), false);
  for (auto v = tree.order.rbegin(); v != tree.order.rend(); ++v) {
    auto& mine = children[*v];
    int& n = count[*v];
    std::sort(mine.begin(), mine.begin() + n,
              [&](int a, int b) { return std::pair(weight[a], a) < std::pair(weight[b], b); });
    for (int k = 0; k < n; ++k) weight[*v] += weight[mine[k]];
    while (weight[*v] > capacity) {
      const int heaviest = mine[--n];
      weight[*v] -= weight[heaviest];
      is_root[heaviest] = true;
    }
    const int p = tree.parent[*v];
    if (p >= 0)
      children[p][count[p]++] = *v;
    else
      is_root[*v] = true;
  }
  part_of.assign(g.node.size(), -1);
  int parts = 0;
  for (const int v : tree.order) part_of[v] = is_root[v] ? parts++ : part_of[tree.parent[v]];
  return parts;
}

Partition partition(const LocalGraph& g, int capacity, std::uint64_t seed, const std::function<bool()>& give_up) {
  return Partitioner(g, capacity, seed, give_up).run();
}

}  // namespace triskin::routing

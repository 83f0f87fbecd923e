// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <bit>
#include <cstdint>
#include <vector>

#include "local_graph.hpp"

namespace triskin::routing {

/// Represents a part of at most 32 nodes as bit sets, for reachability without queues.
struct PartBits {
  int n = 0;
  std::uint32_t all = 0;
  std::array<std::uint32_t, 32> joined{};  ///< Each node has its neighbours as bits.

  explicit PartBits(const LocalGraph& g) : n(g.size()), all(n == 32 ? ~0U : (1U << n) - 1U) {
    for (int v = 0; v < n; ++v) {
      for (const int w : g.neighbour[v]) joined[at(v)] |= w >= 0 ? 1U << w : 0U;
    }
  }
  void cut(int a, int b) {
    joined[at(a)] &= ~(1U << b);
    joined[at(b)] &= ~(1U << a);
  }
  /// Returns the nodes of `allowed` that the seeds reach.
  [[nodiscard]] std::uint32_t reach(std::uint32_t seeds, std::uint32_t allowed) const {
    std::uint32_t seen = seeds & allowed, front = seen;
    while (front != 0) {
      std::uint32_t next = 0;
      for (; front != 0; front &= front - 1) next |= joined[at(std::countr_zero(front))];
      front = next & allowed & ~seen;
      seen |= front;
    }
    return seen;
  }
  /// Returns the sum of distances from v within `allowed`, which must be connected and contain v.
  [[nodiscard]] int sum_of_distances(int v, std::uint32_t allowed) const {
    std::uint32_t seen = 1U << v, front = seen;
    int sum = 0;
    for (int depth = 1; front != 0; ++depth) {
      std::uint32_t next = 0;
      for (; front != 0; front &= front - 1) next |= joined[at(std::countr_zero(front))];
      front = next & allowed & ~seen;
      seen |= front;
      sum += depth * std::popcount(front);
    }
    return sum;
  }
  [[nodiscard]] bool connected(std::uint32_t set) const { return set != 0 && reach(set & (~set + 1), set) == set; }
};

}  // namespace triskin::routing

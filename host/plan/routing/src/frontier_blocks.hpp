// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "folding.hpp"

/// The dynamic programmes over a frontier share this code (frontier.cpp, jumper_frontier.cpp): an order of the nodes
/// that keeps the frontier small, and states that are equal when the nodes of the frontier share parts in the same way.
namespace triskin::routing {

inline constexpr int kMaxFrontier = 12;  ///< A key has no room for more nodes.

/// At position s of the frontier, 4 bits of `label` name its block, and 5 bits of `weight` at the label hold the
/// block's weight. Labels are numbered by first appearance, so equal situations have equal keys.
struct FrontierKey {
  std::uint64_t label = 0, weight = 0;
  bool operator==(const FrontierKey&) const = default;
};
struct FrontierKeyHash {
  std::size_t operator()(const FrontierKey& k) const {
    const std::uint64_t h = k.label * 0x9E3779B97F4A7C15ULL ^ (k.weight + 0x7F4A7C15ULL) * 0xC2B2AE3D27D4EB4FULL;
    return static_cast<std::size_t>(h ^ (h >> 29));
  }
};

/// Unpacks the block of each frontier node and the weights.
struct FrontierBlocks {
  std::array<int, kMaxFrontier + 1> label{};
  std::array<int, kMaxFrontier + 2> weight{};
};
[[nodiscard]] inline FrontierBlocks unpack_blocks(const FrontierKey& key, std::size_t n) {
  FrontierBlocks b;
  for (std::size_t s = 0; s < n; ++s) {
    b.label[s] = static_cast<int>(key.label >> (4 * s) & 15);
    b.weight[at(b.label[s])] = static_cast<int>(key.weight >> (5 * b.label[s]) & 31);
  }
  return b;
}

/// The frontier after one more node: its key, the weight of the parts that stay open, and how many parts were closed
/// because none of their nodes has unplaced neighbours.
struct NextFrontier {
  FrontierKey key;
  int open_weight = 0, closed = 0;
};

/// Returns the frontier after node v, which stands behind its nodes, has joined the blocks `block_at[side]` of the
/// sides set in `joined`; `weight` is then that of v's part. `stays[s]` tells that position s has unplaced neighbours.
/// Cost: some 12 x 3 steps.
[[nodiscard]] inline NextFrontier next_frontier(const FrontierBlocks& before, unsigned joined,
                                                const std::array<int, 3>& block_at, int weight,
                                                const std::vector<bool>& stays) {
  const std::size_t n = stays.size() - 1;
  std::array<int, kMaxFrontier + 2> renamed{};
  renamed.fill(-1);
  const int fresh = kMaxFrontier + 1;  // The block of v has this number.
  const auto block_of = [&](std::size_t position) {
    if (position == n) return fresh;
    for (std::size_t side = 0; side < 3; ++side) {
      if ((joined >> side & 1) != 0 && block_at[side] == before.label[position]) return fresh;
    }
    return before.label[position];
  };
  NextFrontier next;
  int blocks = 0;
  std::size_t out = 0;
  for (std::size_t position = 0; position <= n; ++position) {
    if (!stays[position]) continue;
    const int b = block_of(position);
    if (renamed[at(b)] < 0) {
      renamed[at(b)] = blocks++;
      const int w = b == fresh ? weight : before.weight[at(b)];
      next.open_weight += w;
      next.key.weight |= static_cast<std::uint64_t>(w) << (5 * renamed[at(b)]);
    }
    next.key.label |= static_cast<std::uint64_t>(renamed[at(b)]) << (4 * out++);
  }
  std::array<bool, kMaxFrontier + 2> counted{};
  for (std::size_t position = 0; position <= n; ++position) {
    const int b = block_of(position);
    if (renamed[at(b)] >= 0 || counted[at(b)]) continue;
    counted[at(b)] = true;
    ++next.closed;
  }
  return next;
}

/// An order of nodes, and the widest frontier that it passes through.
struct FrontierOrder {
  Numbers nodes;
  int widest = 0;
};

/// Grows an order of `nodes`, which are connected among themselves, from several starts; the next node is the one that
/// leaves the smallest frontier. Neighbours outside `nodes` do not count. Cost: quadratic in the nodes.
[[nodiscard]] FrontierOrder order_for_small_frontier(const LocalGraph& g, const Numbers& nodes);

}  // namespace triskin::routing

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "triskin/base/index.hpp"

/// Defines the states of the exact programme over joints and jumpers (jumper_frontier.cpp). A slot is what a later node
/// can join: a placed node over a joint, or the far end of a jumper. A block is a part that can still grow.
namespace triskin::routing {

inline constexpr int kMaxSlots = 32, kMaxBlocks = 12;
inline constexpr int kNoBlock =
    15;  ///< This label marks a slot that cannot be joined, because its part is full or its jumper not fitted.

/// Stores the block of each slot in 4 bits; blocks are numbered by first appearance, so equal situations are equal.
struct SlotLabels {
  std::array<std::uint64_t, 2> half{};
  [[nodiscard]] int get(int slot) const { return static_cast<int>(half[at(slot / 16)] >> (4 * (slot % 16)) & 15); }
  void set(int slot, int label) { half[at(slot / 16)] |= static_cast<std::uint64_t>(label) << (4 * (slot % 16)); }
  bool operator==(const SlotLabels&) const = default;
};
struct SlotLabelsHash {
  std::size_t operator()(const SlotLabels& k) const {
    const std::uint64_t h = k.half[0] * 0x9E3779B97F4A7C15ULL ^ (k.half[1] + 0x7F4A7C15ULL) * 0xC2B2AE3D27D4EB4FULL;
    return static_cast<std::size_t>(h ^ (h >> 29));
  }
};

struct JumperState {
  SlotLabels labels;
  std::uint64_t weights = 0;  ///< Each block has five bits, of which the highest is 0.
  std::int64_t cost = 0;      ///< The cost covers the closed parts and the fitted jumpers.
  int before = -1;            ///< The state numbered so in the previous layer led here.
  std::uint8_t blocks = 0;
  std::uint8_t joined = 0;  ///< At these sides the node joined a neighbour's part.

  [[nodiscard]] int weight(int block) const { return static_cast<int>(weights >> (5 * block) & 31); }
  /// Returns true if, with the same labels, everything that completes `other` completes this at no higher price.
  [[nodiscard]] bool beats(const JumperState& other) const {
    constexpr std::uint64_t kGuards = 0x0842108421084210ULL;  // The mask has bit 4 of each of 12 fields.
    return cost <= other.cost && (((other.weights | kGuards) - weights) & kGuards) == kGuards;
  }
};

}  // namespace triskin::routing

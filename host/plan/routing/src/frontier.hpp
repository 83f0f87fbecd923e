// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <vector>

#include "folding.hpp"

namespace triskin::routing {

enum class Decision { kFeasible, kInfeasible, kTooLarge };

struct FrontierAnswer {
  Decision decision = Decision::kTooLarge;
  Table<int, Numbers> parts;  ///< If the graph is feasible, all parts of it are listed.
};

/// Decides exactly whether the folded graph can be divided into at most k parts. A dynamic programme adds the core's
/// nodes one by one and keeps, for the nodes that still have unplaced neighbours (the frontier), which of them share a
/// part and the weight of each such part (docs/routing.md). A state is dropped when its closed parts and ⌈open weight
/// / capacity⌉ exceed k. Answers kTooLarge after `budget` state transitions or when the frontier exceeds 12 nodes;
/// transitions are counted, so the answer is equal on every machine.
[[nodiscard]] FrontierAnswer divide_exactly(const LocalGraph& g, const Folding& folding, int capacity, int k,
                                            long budget);

}  // namespace triskin::routing

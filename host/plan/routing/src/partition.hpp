// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <vector>

#include "local_graph.hpp"
#include "triskin/routing/routing.hpp"

namespace triskin::routing {

struct Partition {
  /// Each local node has its part, 0 … parts − 1; every part is connected and has at most `capacity` nodes.
  Numbers part_of;
  int parts = 0;
  int lower_bound = 0;
  PartitionProof proof = PartitionProof::kOpen;
};
/// Divides a connected graph into the fewest connected parts of at most `capacity` nodes: random trees cut bottom-up,
/// peel, exact frontier programme. All steps are counted, never timed, so the result is equal on every machine.
/// `give_up` is asked between the searches; when it returns true, the best partition so far is the answer, after one
/// tree at least.
[[nodiscard]] Partition partition(const LocalGraph& g, int capacity, std::uint64_t seed,
                                  const std::function<bool()>& give_up = {});

/// Cuts a spanning tree bottom-up: if a subtree exceeds the capacity, its heaviest branch becomes a part. This gives
/// the fewest parts for the tree (Kundu and Misra, SIAM J. Comput. 6, 1977). Returns their number; fills part_of.
int cut_tree(const LocalGraph& g, const SpanningTree& tree, int capacity, Numbers& part_of);

/// Peels off parts of capacity − slack … capacity nodes, each a subtree of a random spanning tree of the rest, so
/// that both stay connected; when stuck, gives some neighbouring parts back and continues. Returns true and fills
/// part_of when k parts are enough.
bool peel(const LocalGraph& g, int capacity, int k, long budget, Dice& random, Numbers& part_of);

}  // namespace triskin::routing

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <vector>

#include "triskin/routing/local_graph.hpp"
#include "triskin/routing/routing.hpp"

namespace triskin::geometry {

struct Partition {
  /// Each local node has its part, 0 … parts − 1; every part is connected and has at most `capacity` nodes.
  std::vector<int> part_of;
  int parts = 0;
  int lower_bound = 0;
  PartitionProof proof = PartitionProof::kOpen;
};
/// Divides a connected graph into the fewest connected parts of at most `capacity` nodes: random trees cut bottom-up,
/// peel, exact frontier programme: all counted, never timed, so equal on every machine. `give_up` is asked between the
/// searches; when it answers true, the best partition so far is the answer, after one tree at least.
[[nodiscard]] Partition partition(const LocalGraph& g, int capacity, std::uint64_t seed,
                                  const std::function<bool()>& give_up = {});

/// Bottom-up cut of a spanning tree: where a subtree outgrows the capacity its heaviest branch becomes a part. Fewest
/// parts for this tree (Kundu and Misra, SIAM J. Comput. 6, 1977). Returns their number; fills part_of.
int cut_tree(const LocalGraph& g, const SpanningTree& tree, int capacity, std::vector<int>& part_of);

/// Peels parts of capacity − slack … capacity nodes off, each a subtree of a random spanning tree of what is left,
/// so that both stay connected; when stuck gives some neighbouring parts back and goes on. True and fills part_of when
/// k parts do.
bool peel(const LocalGraph& g, int capacity, int k, long budget, Dice& random, std::vector<int>& part_of);

}  // namespace triskin::geometry

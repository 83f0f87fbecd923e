// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "jumper_graph.hpp"
#include "triskin/base/dice.hpp"

namespace triskin::routing {

/// Every part is connected in `joined`.
struct JumperDivision {
  Numbers part_of;  ///< Each local node has its part, 0 … parts − 1.
  int parts = 0, jumpers = 0;

  /// Takes another division if it is cheaper, or if there is none yet; returns whether it did.
  bool offer(const JumperGraph& g, const IntegerPrice& price, const Numbers& other, int other_parts);
};

/// Improves a division of the graph, or makes one, into parts of at most `capacity` ≤ 16 nodes until it costs no more
/// than `bound`: random spanning trees that take joints before jumpers, each divided exactly, over the whole and again
/// over neighbouring parts. Counted, never timed; `give_up` is asked now and then, after the first 10 ms or so.
void search_division(const JumperGraph& g, int capacity, const IntegerPrice& price, std::int64_t bound, Dice& random,
                     const std::function<bool()>& give_up, JumperDivision& best);

}  // namespace triskin::routing

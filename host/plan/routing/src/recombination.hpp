// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "part_bits.hpp"
#include "partition.hpp"

namespace triskin::routing {

/// These inputs, besides the joints of a part, affect its secondary cost.
struct PartSurroundings {
  std::uint32_t border = 0;  ///< A cable can reach a side of these nodes.
  /// Each is the cable length from the controller place, or zero if no place is given.
  std::array<int, 32> cable_cm{};
  bool jumpers = false;
  std::array<std::uint32_t, 32> over_jumper{};  ///< Each node has the neighbours to which a jumper leads.
};

/// Returns the secondary cost of the connected set `part`, in integers so that every compiler decides alike: jumpers
/// ≫ no border side ≫ modules lost beyond the failed one, summed over all module failures, with the best second
/// entry > Σ depth from the entry.
[[nodiscard]] int secondary_cost(const PartBits& bits, const PartSurroundings& around, std::uint32_t part);

/// Lowers the sum of secondary costs under a fixed number of parts. A move takes two neighbouring parts and either
/// draws a random tree over both and cuts it elsewhere (ReCom: DeFord, Duchin and Solomon, 2021) or moves or swaps
/// single modules; it is accepted under a falling threshold. `moves` is the total; about 10 µs each. `over_jumper`
/// tells by local node and side which joints are jumpers (null: none); their number does not grow.
void recombine(const ModuleGraph& graph, const LocalGraph& g, const RoutingOptions& options, int moves, Dice& random,
               Partition& partition, const Table<int, Triple<bool>>* over_jumper = nullptr);

}  // namespace triskin::routing

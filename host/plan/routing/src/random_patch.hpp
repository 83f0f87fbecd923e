// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <set>
#include <vector>

#include "triskin/design/design_types.hpp"

namespace triskin::routing {

/// Random patches are round; two to five rows high; round with holes of one to seven tiles; or tree-like.
enum class PatchShape { kCompact, kStrip, kHoled, kDendritic };

struct LatticePatch {
  std::vector<Tile> tiles;  ///< The tiles are sorted.
  /// Node k is tiles[k]; nodes are joined where two tiles share a side, and every free side is border.
  ModuleGraph graph;
};

/// Returns the graph of a set of tiles. Cost: O(n log n).
[[nodiscard]] LatticePatch lattice_patch(const std::set<Tile>& tiles);

/// Makes a connected patch of n ≥ 1 tiles around the origin, for tests and benchmarks. A seed gives the same patch on
/// every machine. Cost: O(n²) for compact shapes.
[[nodiscard]] LatticePatch random_patch(PatchShape shape, int n, std::uint64_t seed);

}  // namespace triskin::routing

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <random>
#include <set>
#include <vector>

#include "triskin/geometry/design_types.hpp"
#include "triskin/geometry/routing.hpp"

namespace triskin::geometry {

/// Shapes of random patches: round; two to five rows high; round with holes of one to seven tiles; tree-like.
enum class PatchShape { kCompact, kStrip, kHoled, kDendritic };

/// Random numbers that are equal on every compiler (the standard's distributions are not).
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

 private:
  std::mt19937_64 engine_;
};

struct LatticePatch {
  std::vector<Tile> tiles;  ///< sorted
  ModuleGraph graph;        ///< node k is tiles[k]; joined where two tiles share a side, every free side is border
};

[[nodiscard]] LatticePatch lattice_patch(const std::set<Tile>& tiles);

/// A connected patch of n ≥ 1 tiles around the origin, for tests and benchmarks. Equal for a seed on every machine.
/// Cost: O(n²) for compact shapes.
[[nodiscard]] LatticePatch random_patch(PatchShape shape, int n, std::uint64_t seed);

}  // namespace triskin::geometry

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "triskin/placement/paper/algorithm1.hpp"

namespace triskin::placement::paper {

/// Numbers the set ℜ of Section V.
enum class Heuristic : std::uint8_t { kR1 = 1, kR2, kR3, kR4, kR5, kR6, kR7 };

/// Settles what the paper leaves open (docs/paper.md, Section V). |V| is the number of vertices of the outer ring.
struct HeuristicOptions {
  /// Selects the generating line through the selected node: 0, 60 or 300 degrees. By the symmetry of the grid the
  /// placements of R2, R3 and R4 have the same values for any of them.
  int line_deg = 0;
  std::array<int, 2> node{0, 0};
  /// Sets the number of random draws. R1: placements in all (0: 1,000). R5: places beside the node for each placement
  /// of R2 (0: 1). R6: angles for each vertex (0: 2). R7: places beside the node for each pair of vertices (0: |V|/2,
  /// rounded up, as the times of Table I suggest).
  int draws = 0;
  std::uint64_t seed = 1;
  /// Above 1, R3, R4 and R7 take only every n-th pair of vertices as a sample; 1 is the heuristic of the paper.
  std::int64_t pair_step = 1;
};

/// Receives the placements of Ξ one by one and returns false to stop.
using PlacementVisitor = std::function<bool(const PivotedPlacement&)>;

/// Produces Ξ_Ri in the order of the paper (Section V; R4 is Algorithm 3 of Appendix A). The list is not stored,
/// because that of R4 has 2*10⁸ placements at 700 vertices. Deterministic for a seed. Throws std::invalid_argument
/// for a line that is no generating line, negative draws, a pair step below 1.
void produce_placements(Heuristic heuristic, const Polygon& polygon, const HeuristicOptions& options,
                        const PlacementVisitor& visit);

/// Returns |Ξ_Ri| for a polygon of `vertices` vertices and pair_step 1: R2 2|V|, R3 |V|(|V| - 1)/2, R4 |V|²(|V| −
/// 1)/2, the others by their draws.
[[nodiscard]] std::int64_t placement_count(Heuristic heuristic, std::int64_t vertices,
                                           const HeuristicOptions& options = {});

struct BestPlacement {
  /// There is none when no placement holds a module; the paper calls it ρ*.
  std::optional<PivotedPlacement> placement;
  int modules = 0;               ///< The paper calls this number ℭ*.
  std::vector<Tile> patch;       ///< The tiles are sorted; the paper calls the set ℙ*.
  std::int64_t evaluations = 0;  ///< Algorithm 1 evaluated this many placements.
  bool complete = true;          ///< False means that the deadline ended the search.
};

/// Runs Algorithm 2 (Section V): evaluates the placements of each heuristic by Algorithm 1 and keeps the first of the
/// best. Throws std::invalid_argument as produce_placements and Algorithm1 do. Cost: the sum of placement_count
/// evaluations; one thread.
[[nodiscard]] BestPlacement algorithm2(
    const Polygon& polygon, std::span<const Heuristic> heuristics, const HeuristicOptions& options = {},
    const Algorithm1Options& evaluation = {},
    std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max());

}  // namespace triskin::placement::paper

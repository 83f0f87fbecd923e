// SPDX-License-Identifier: GPL-3.0-or-later
// Implements Algorithm 2 of the paper (Section V).
#include "triskin/placement/paper/heuristics.hpp"

namespace triskin::placement::paper {

BestPlacement algorithm2(const Polygon& polygon, std::span<const Heuristic> heuristics, const HeuristicOptions& options,
                         const Algorithm1Options& evaluation, std::chrono::steady_clock::time_point deadline) {
  Algorithm1 algorithm1(polygon, evaluation);
  BestPlacement best;
  for (const Heuristic heuristic : heuristics) {
    produce_placements(heuristic, polygon, options, [&](const PivotedPlacement& at) {
      if (std::chrono::steady_clock::now() > deadline) {
        best.complete = false;
        return false;
      }
      ++best.evaluations;
      const int modules = algorithm1.count(at);
      if (modules > best.modules) {
        best.modules = modules;
        best.placement = at;
      }
      return true;
    });
  }
  if (best.placement) best.patch = algorithm1.patch(*best.placement);
  return best;
}

}  // namespace triskin::placement::paper

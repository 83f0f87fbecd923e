// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <utility>
#include <vector>

#include "triskin/mesh/extract_steps.hpp"

namespace triskin::mesh {

struct CrossingSearch {
  int threads = 1;       ///< The number must be at least 1; a child process uses one thread.
  bool any_one = false;  ///< True ends the search at the first pair that is found.
  IsLate is_late{};      ///< The search asks this after about every ten thousand faces and ends when it answers true.
};

struct Crossings {
  /// The pairs are sorted.
  std::vector<FacePair> pairs;
  /// This many faces were tested against all others; a search that ended early has tested fewer than all.
  std::size_t tested = 0;
};

/// Finds pairs of faces that pass through or touch each other beyond a common edge or corner. An edge may have two
/// faces at most, and they must agree in orientation. Pairs that a plane separates by more than rounding are skipped;
/// the others are tested with exact predicates. Cost: O(n log n) typical, 1.5 µs of processor time per face.
[[nodiscard]] Crossings find_crossings(const Mesh& mesh, const CrossingSearch& search);

}  // namespace triskin::mesh

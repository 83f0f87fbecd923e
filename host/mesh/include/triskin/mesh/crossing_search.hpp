// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <utility>
#include <vector>

#include "triskin/mesh/extract_steps.hpp"

namespace triskin::geometry {

/// How a mesh is searched for faces that cross.
struct CrossingSearch {
  int threads = 1;       ///< At least 1; a child process uses one thread.
  bool any_one = false;  ///< The search ends with the first pair that is found.
  IsLate is_late{};      ///< It ends the search, and is asked after every ten thousand faces or so.
};

/// Pairs of crossing faces, and the cost of the search.
struct Crossings {
  /// Each pair is the lower and the higher number of two faces, sorted; a face without area is listed with itself.
  std::vector<std::pair<int, int>> pairs;
  std::size_t tested = 0;  ///< So many faces were tested against all others.
};

/// Pairs of faces that pass through or touch each other beyond a common edge or corner. The faces at an edge are two at
/// most and agree in orientation. What planes part by more than rounding is passed over; the others are tested with
/// exact predicates. Cost: O(n log n) typical, 1.5 µs of processor time a face.
[[nodiscard]] Crossings find_crossings(const Mesh& mesh, const CrossingSearch& search);

}  // namespace triskin::geometry

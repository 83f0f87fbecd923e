// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <utility>
#include <vector>

#include "extract_steps.hpp"

namespace triskin::geometry {

/// How a mesh is searched for faces that cross.
struct CrossingSearch {
  int threads = 1;       ///< ≥ 1; 1 in a child process
  bool any_one = false;  ///< the first that is found ends the search
  IsLate is_late{};      ///< ends the search; asked between some ten thousands of faces
};

/// Pairs of crossing faces, and the cost of the search.
struct Crossings {
  std::vector<std::pair<int, int>> pairs;  ///< low and high number of two faces, sorted; one twice: it has no area
  std::size_t tested = 0;                  ///< faces that were tested against all others
};

/// Pairs of faces that pass through or touch each other beyond a common edge or corner. The faces at an edge are two at
/// most and agree in orientation. What planes part by more than rounding is passed over; the others are tested with
/// exact predicates. Cost: O(n log n) typical, 1.5 µs of processor time a face.
[[nodiscard]] Crossings find_crossings(const Mesh& mesh, const CrossingSearch& search);

}  // namespace triskin::geometry

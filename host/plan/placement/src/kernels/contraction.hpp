// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "search/cell_list.hpp"

namespace triskin::placement {

/// Contracts a cell: clips its box, axis by axis, to the range in which at least `need` of the tiles' boxes overlap.
class Contraction {
 public:
  /// Returns false if on some axis fewer than `need` boxes overlap everywhere; `box` is then undefined within its old
  /// bounds.
  bool clip(MotionBox& box, const OffsetBoxes& boxes, int need);

 private:
  bool sweep(const std::vector<double>& lows, const std::vector<double>& highs, double half, int need, double& low,
             double& high);

  static constexpr int kBins = 64;
  std::array<int, kBins + 1> change_{};
};

}  // namespace triskin::placement

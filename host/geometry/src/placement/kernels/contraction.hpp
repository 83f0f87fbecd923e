// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "placement/search/cell_list.hpp"

namespace triskin::geometry {

/// Clips a cell to where at least `need` of the tiles' boxes overlap, one axis after the other.
class Contraction {
 public:
  /// False: they overlap nowhere. Then `box` may be partly clipped.
  bool clip(MotionBox& box, const OffsetBoxes& boxes, int need);

 private:
  bool sweep(const std::vector<double>& lows, const std::vector<double>& highs, double half, int need, double& low,
             double& high);

  static constexpr int kBins = 64;
  std::array<int, kBins + 1> change_{};
};

}  // namespace triskin::geometry

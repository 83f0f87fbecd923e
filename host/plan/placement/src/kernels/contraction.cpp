// SPDX-License-Identifier: GPL-3.0-or-later
#include "kernels/contraction.hpp"

#include <algorithm>

namespace triskin::placement {

bool Contraction::clip(MotionBox& box, const OffsetBoxes& boxes, int need) {
  if (need <= 0) return true;
  if (static_cast<int>(boxes.low[0].size()) < need) return false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double center = box.center(axis), half = box.half(axis);
    double low = -half, high = half;
    if (!sweep(boxes.low[axis], boxes.high[axis], half, need, low, high)) return false;
    // Faces keep their bits if nothing is clipped, because the cells of a proof must fit together.
    if (low > -half) box.low[axis] = std::max(box.low[axis], center + low);
    if (high < half) box.high[axis] = std::min(box.high[axis], center + high);
  }
  return true;
}

// Coverage is counted in bins; a box covers every bin that it touches, so that the count can only be too high.
bool Contraction::sweep(const std::vector<double>& lows, const std::vector<double>& highs, double half, int need,
                        double& low, double& high) {
  if (!(half > 1e-14)) return true;
  const double scale = 0.5 * kBins / half;
  change_.fill(0);
  const auto bin = [](double position) {
    return static_cast<std::size_t>(std::clamp(static_cast<int>(position), 0, kBins - 1));
  };
  for (std::size_t k = 0; k < lows.size(); ++k) {
    ++change_[bin((lows[k] + half) * scale - 1e-9)];
    --change_[bin((highs[k] + half) * scale + 1e-9) + 1];
  }
  int depth = 0, first = -1, last = -1;
  for (int k = 0; k < kBins; ++k) {
    depth += change_[static_cast<std::size_t>(k)];
    if (depth < need) continue;
    if (first < 0) first = k;
    last = k;
  }
  if (first < 0) return false;
  if (first > 0) low = first / scale - half;
  if (last + 1 < kBins) high = (last + 1) / scale - half;
  return true;
}

}  // namespace triskin::placement

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "kernels/tile_grid.hpp"

namespace triskin::placement {

/// Lists tiles side by side with edges that may cut them: the edge's ends seen from the centre of the tile, its unit
/// normal, and +1 for an up tile, −1 for a down one.
class CutPairs {
 public:
  void clear() { count_ = 0; }
  void add(double ax, double ay, double bx, double by, double nx, double ny, double sign) {
    if (count_ == room_) grow();
    double* to = lanes_.data() + count_ / kLanes * kBlock + count_ % kLanes;
    to[0] = ax;
    to[kLanes] = ay;
    to[2 * kLanes] = bx;
    to[3 * kLanes] = by;
    to[4 * kLanes] = nx;
    to[5 * kLanes] = ny;
    to[6 * kLanes] = sign;
    ++count_;
  }
  [[nodiscard]] std::size_t size() const { return count_; }

  /// Tests all pairs: 0 if a side of the tile or the edge itself separates both by `inset_mm`, else 255. The widest
  /// instruction set of the processor is chosen at the first call; all do the same IEEE operations and give the same
  /// bits.
  [[nodiscard]] const std::vector<std::uint8_t>& cuts(const TileGrid& grid, double inset_mm);

  static constexpr std::size_t kLanes = 8, kFields = 7, kBlock = kLanes * kFields;

 private:
  void grow();

  std::vector<double> lanes_;
  std::vector<std::uint8_t> cut_;
  std::size_t count_ = 0, room_ = 0;
};

}  // namespace triskin::placement

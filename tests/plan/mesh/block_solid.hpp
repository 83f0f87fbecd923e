// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <functional>
#include <vector>

#include "walled_parts.hpp"

namespace triskin::testing {

/// Builds a solid of boxes along the axes, bent by a map: sharp edges, ribs, bosses and letters as CAD has them. The
/// map takes (x, y, z) in mm of the unbent solid.
class BlockSolid {
 public:
  using Bend = std::function<design::Vec3(const design::Vec3&)>;
  /// Decides the side of a face from its middle and normal before the solid is bent.
  using SideRule = std::function<int(const design::Vec3& middle, const design::Vec3& normal)>;

  /// `step_mm` is the longest edge of a facet along each axis. With `period_mm` > 0, x and x + period are the same
  /// place.
  explicit BlockSolid(double step_mm, double period_mm = 0.0) : step_mm_(step_mm), period_mm_(period_mm) {}

  BlockSolid& add(const design::Vec3& low, const design::Vec3& high) { return put(low, high, true); }
  BlockSolid& cut(const design::Vec3& low, const design::Vec3& high) { return put(low, high, false); }

  /// Adds the boundary to a part; it is closed and faces outward if no two boxes touch only in an edge.
  void append_to(WalledPart& part, const Bend& bend, const SideRule& side) const;

 private:
  struct Block {
    design::Vec3 low, high;
    bool is_solid;
  };
  BlockSolid& put(const design::Vec3& low, const design::Vec3& high, bool is_solid) {
    blocks_.push_back({low, high, is_solid});
    return *this;
  }
  [[nodiscard]] std::vector<double> lines(int axis) const;
  [[nodiscard]] bool is_solid(const design::Vec3& p) const;

  double step_mm_, period_mm_;
  std::vector<Block> blocks_;
};

}  // namespace triskin::testing

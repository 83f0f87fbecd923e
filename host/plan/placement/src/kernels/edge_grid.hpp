// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/pair_kernel.hpp"
#include "kernels/tile_polygon.hpp"
#include "search/cell_list.hpp"

namespace triskin::placement {

/// A bucket grid of the edges in the polygon's frame that finds edges near a point in constant time. Immutable, so any
/// number of threads may read it.
class EdgeGrid {
 public:
  EdgeGrid(const PreparedPolygon& polygon, double reach_mm);
  [[nodiscard]] double reach_mm() const { return reach_mm_; }
  /// Returns all edges within reach_mm of p, and some others.
  [[nodiscard]] std::span<const std::uint32_t> near(const Vec2& p) const;

 private:
  double reach_mm_ = 0.0, origin_ = 0.0, scale_ = 1.0;
  int buckets_ = 1;
  std::vector<std::uint32_t> first_, edges_;
};

/// Writes the tiles of `from` to `to`, each with the edges that come within reach_mm of its centre at the middle of the
/// box.
void list_with_edges(const PreparedPolygon& polygon, const EdgeGrid& edges, const MotionBox& box, double reach_mm,
                     const CellList& from, CellList& to);

}  // namespace triskin::placement

// SPDX-License-Identifier: GPL-3.0-or-later
#include "search/slices.hpp"

#include <algorithm>
#include <cmath>

#include "kernels/slice_raster.hpp"

namespace triskin::placement {
namespace {

constexpr double kSlice_mm = 2.5;  // The farthest vertex moves this far from one side of a slice to the other.

}  // namespace

double slice_child_reach_mm(const PreparedPolygon& polygon, const TileGrid& grid, const MotionBox& box,
                            double certain_mm) {
  return std::hypot(box.half(0), box.half(1)) + (polygon.radius_mm + 4.0 * grid.circumradius_mm) * box.half(2) +
         grid.circumradius_mm + std::max(0.0, certain_mm);
}

double kept_inradius(const TileGrid& grid, double inset_mm) {
  return 1.0 + std::min(0.0, inset_mm) / grid.inradius_mm;
}

std::vector<MotionBox> slices_of(const PreparedPolygon& polygon, const TileGrid& grid, double inset_mm) {
  const double kept = kept_inradius(grid, inset_mm), period = grid.period_rad * (1.0 + 1e-12);
  // Inside a part no centre may move by as much as the inset leaves of the inradius.
  const double part = 0.5 * std::hypot(grid.row_step_mm, grid.row_height_mm) / SliceRaster::kSteps;
  const double width = std::min(kept * kSlice_mm, 2.0 * (0.9 * kept * grid.inradius_mm - part));
  const int n = std::max(static_cast<int>(std::ceil(period * polygon.radius_mm / width)), 1);
  std::vector<MotionBox> slices;
  for (int k = n - 1; k >= 0; --k) {
    MotionBox& box = slices.emplace_back();
    box.high = {grid.row_step_mm, grid.row_height_mm * (1.0 + 1e-12), period * (k + 1) / n};
    box.low[2] = period * k / n;
  }
  return slices;
}

}  // namespace triskin::placement

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <span>

#include "triskin/design/mesh.hpp"
#include "triskin/design/tile.hpp"

/// The corners of a module may be cut off, and all code takes the outline from here. A cut of c mm removes c mm along
/// each side from every corner, a triangle of side c. The result is a hexagon with three long sides (30 mm - 2c) and
/// three short ones (c). Source: the reference paper, Section III-A (docs/paper.md).
namespace triskin::design {

/// A module may not be cut more, because at 6.93 mm the centres of three taxels lie on the short sides.
inline constexpr double kMaxCornerCut_mm = 6.9;
/// Up to this cut every taxel is as far from the short sides as from the long ones (3 mm), so no pad is cut.
inline constexpr double kHarmlessCornerCut_mm = 3.4;

/// Returns the height in mm of the triangle that a cut removes at a corner; no point of it is farther from the module.
[[nodiscard]] constexpr double cut_height_mm(double corner_cut_mm) {
  return corner_cut_mm * kHeight_mm / kSide_mm;
}
/// Returns the distance in mm of a short side from the module's centre.
[[nodiscard]] constexpr double short_side_offset_mm(double corner_cut_mm) {
  return 2.0 * kHeight_mm / 3.0 - cut_height_mm(corner_cut_mm);
}
/// Returns the area of a module in mm²; without a cut it is kModuleArea_mm2.
[[nodiscard]] constexpr double module_area_mm2(double corner_cut_mm) {
  const double cut = corner_cut_mm / kSide_mm;
  return kModuleArea_mm2 * (1.0 - 3.0 * cut * cut);
}

/// Corners of an outline in order; without a cut they are the three corners of the module.
struct Outline {
  std::array<Vec3, 6> point;
  std::size_t size = 3;
  [[nodiscard]] std::span<const Vec3> points() const& { return {point.data(), size}; }
  // The overload is deleted because the span would outlive the outline.
  std::span<const Vec3> points() const&& = delete;
};

/// Returns the outline of the module with these corners (of the whole triangle, tile order). With a cut, point 2k lies
/// on side k near corner k and point 2k + 1 on side k near corner k + 1: even sides of the outline are long, odd ones
/// short. `corner_cut_mm`: 0 … kMaxCornerCut_mm, not checked.
[[nodiscard]] inline Outline outline_of(const std::array<Vec3, 3>& corner_mm, double corner_cut_mm) {
  Outline o;
  if (corner_cut_mm <= 0.0) {
    std::ranges::copy(corner_mm, o.point.begin());
    return o;
  }
  o.size = 6;
  const double part = corner_cut_mm / kSide_mm;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 &from = corner_mm[k], &to = corner_mm[(k + 1) % 3];
    o.point[2 * k] = from + part * (to - from);
    o.point[2 * k + 1] = to - part * (to - from);
  }
  return o;
}

/// Returns the outline with every side moved inwards by `inset_mm` ≥ 0, which must be below the inradius of 8.66 mm.
[[nodiscard]] inline Outline inset_outline(const std::array<Vec3, 3>& corner_mm, double corner_cut_mm,
                                           double inset_mm) {
  const Vec3 center = (corner_mm[0] + corner_mm[1] + corner_mm[2]) / 3.0;
  const double scale = 1.0 - 3.0 * inset_mm / kHeight_mm;
  // The corner of the smaller triangle moves inwards by twice the inset, its short side by the inset.
  const double cut_mm = std::max(0.0, corner_cut_mm - inset_mm * kSide_mm / kHeight_mm);
  std::array<Vec3, 3> corner;
  for (std::size_t k = 0; k < 3; ++k) corner[k] = center + scale * (corner_mm[k] - center);
  return outline_of(corner, scale > 0.0 ? cut_mm / scale : 0.0);
}

}  // namespace triskin::design

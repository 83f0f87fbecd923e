// SPDX-License-Identifier: GPL-3.0-or-later
#include "shield_plane.hpp"

#include <boost/polygon/polygon.hpp>
#include <cmath>
#include <numbers>

#include "module_board.hpp"
#include "module_tracks.hpp"
#include "triskin/design/outline.hpp"

namespace triskin::fabrication {
namespace {

using design::Vec2;
using Polygon = boost::polygon::polygon_data<int>;
using Polygons = boost::polygon::polygon_set_data<int>;

constexpr double kUnit_mm = 1e-4;  // coordinates of the polygons are whole numbers of these

Polygon polygon_of(const Ring& ring) {
  std::vector<boost::polygon::point_data<int>> points;
  for (const Vec2& p : ring)
    points.emplace_back(static_cast<int>(std::lround(p.x() / kUnit_mm)),
                        static_cast<int>(std::lround(p.y() / kUnit_mm)));
  Polygon polygon;
  polygon.set(points.begin(), points.end());
  return polygon;
}

// A regular polygon around a circle, so that no point of its border is nearer than the radius.
Polygon gap_around(const Vec2& middle, double radius_mm) {
  constexpr int kCorners = 24;
  const double corner_mm = radius_mm / std::cos(std::numbers::pi / kCorners) + kUnit_mm;
  Ring ring;
  for (int k = 0; k < kCorners; ++k) {
    const double angle_rad = 2.0 * std::numbers::pi * k / kCorners;
    ring.push_back(middle + corner_mm * Vec2(std::cos(angle_rad), std::sin(angle_rad)));
  }
  return polygon_of(ring);
}

Ring plane_outline() {
  constexpr double kSideFromMiddle_mm = design::kHeight_mm / 3.0;
  const double short_side_mm = design::short_side_offset_mm(kMaxBoardCornerCut_mm) - kEdgeClearance_mm;
  // Half the length of a long side: where it meets the short ones, which lie `short_side_mm` from the middle.
  const double inset_mm = kSideFromMiddle_mm - kShieldInset_mm;
  const double half_mm = (2.0 * short_side_mm - inset_mm) / std::numbers::sqrt3;
  Ring ring;
  for (int port = 0; port < 3; ++port) {
    for (const double along_mm : {-half_mm, half_mm})
      ring.push_back(rotated({along_mm, -inset_mm}, 2.0 * std::numbers::pi / 3.0 * port));
  }
  return ring;
}

}  // namespace

std::vector<Ring> shield_plane(const Vec2& center_mm, double angle_rad) {
  const auto here = [&](const Vec2& p) { return Vec2(center_mm + rotated(p, angle_rad)); };
  Polygons plane, gaps;
  Ring outer = plane_outline();
  for (Vec2& p : outer) p = here(p);
  plane.insert(polygon_of(outer));
  constexpr double kGap_mm = kContactPad_mm / 2.0 + kClearance_mm;
  for (const ModulePad& pad : module_pads()) {
    if (pad.layer == PadLayer::kThrough) gaps.insert(gap_around(here(pad.at_mm), kGap_mm));
  }
  for (const ModuleVia& via : module_routing().vias) {
    if (via.pad != kShieldPin) gaps.insert(gap_around(here(via.at_mm), kGap_mm));
  }
  using namespace boost::polygon::operators;
  plane -= gaps;
  std::vector<Polygon> parts;
  plane.get(parts);
  std::vector<Ring> rings;
  for (const Polygon& part : parts) {
    Ring ring;
    for (const auto& p : part) ring.emplace_back(kUnit_mm * p.x(), kUnit_mm * p.y());
    if (ring.size() > 1 && (ring.front() - ring.back()).norm() == 0.0) ring.pop_back();
    rings.push_back(std::move(ring));
  }
  return rings;
}

}  // namespace triskin::fabrication

// SPDX-License-Identifier: GPL-3.0-or-later
#include "route_grid.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "triskin/base/index.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/geometry/segment.hpp"

namespace triskin::fabrication {
namespace {

using design::Vec2;

constexpr double kGridInradius_mm = design::kHeight_mm / 3.0;
constexpr double kHalfTrack_mm = kNarrowTrack_mm / 2.0, kViaRadius_mm = kContactPad_mm / 2.0;
constexpr double kHoleGap_mm = 0.25;  // Drilled holes stay this far apart, also those of one net.
// Copper of two nets on the touch side, where the plane lies 0.05 mm below.
constexpr double kFrontGap_mm = 0.12;
constexpr int kFront = 0, kRingLayer = 2;

double from_side_mm(const Vec2& p, int side) {
  const Vec2 outward = Eigen::Rotation2Dd(2.0 * std::numbers::pi / 3.0 * side) * Vec2(0, -1);
  return kGridInradius_mm - outward.dot(p);
}
double inset_of_mm(const Vec2& p) {
  return std::min({from_side_mm(p, 0), from_side_mm(p, 1), from_side_mm(p, 2)});
}
// The distance to the nearest short side of the outline at the largest corner cut.
double from_cut_mm(const Vec2& p) {
  double farthest = 0.0;
  for (int corner = 0; corner < 3; ++corner) {
    const Vec2 towards = Eigen::Rotation2Dd(2.0 * std::numbers::pi / 3.0 * corner) * Vec2(0, 1);
    farthest = std::max(farthest, towards.dot(p));
  }
  return design::short_side_offset_mm(kMaxBoardCornerCut_mm) - farthest;
}

}  // namespace

double FixedCopper::distance_mm(const Vec2& p) const {
  if (half_size_mm.x() > 0.0) {
    const Vec2 local = Eigen::Rotation2Dd(-angle_rad) * (p - from_mm);
    return (local.cwiseAbs() - half_size_mm).cwiseMax(0.0).norm();
  }
  return std::max(0.0, geometry::distance_to_segment(p, from_mm, to_mm) - radius_mm);
}

RouteGrid::RouteGrid(const std::vector<FixedCopper>& copper, const std::vector<NetKind>& kinds)
    : width_(static_cast<int>(design::kSide_mm / kGridPitch_mm) + 1),
      height_(static_cast<int>(design::kHeight_mm / kGridPitch_mm) + 1),
      track_(at(kCopperLayers * nodes_per_layer()), kFree),
      via_(at(nodes_per_layer()), kFree),
      window_(at(nodes_per_layer()), 0),
      kinds_(kinds) {
  for (int place = 0; place < nodes_per_layer(); ++place) {
    const Vec2 p = place_mm(place);
    window_[at(place)] = in_sensor_window(p) ? 2 : in_sensor_window(p, kSensorGap_mm) ? 1 : 0;
  }
  block_edges();
  for (const FixedCopper& piece : copper) block_copper(piece);
}

bool in_sensor_window(const Vec2& p, double margin_mm) {
  constexpr double kNear_mm = 1.55, kFar_mm = 3.07, kHalf_mm = 1.6;
  const auto inside = [&](double outward, double along) {
    return outward > kNear_mm - margin_mm && outward < kFar_mm + margin_mm && std::abs(along) < kHalf_mm + margin_mm;
  };
  return inside(-p.x(), p.y()) || inside(-p.y(), p.x());
}

bool RouteGrid::may_track(int index, int net) const {
  if (!is_allowed(track_[at(index)], net)) return false;
  const int layer = index / nodes_per_layer();
  const int window = window_[at(index % nodes_per_layer())];
  switch (kinds_[at(net)]) {
    case NetKind::kSensor:
      return layer == kFront || (layer == kCopperLayers - 1 && window == 2);
    case NetKind::kShield:
      return layer == kShieldLayer || (layer == kCopperLayers - 1 && window == 0);
    case NetKind::kDigital:
      return layer > kShieldLayer && window == 0;
  }
  return false;
}

bool RouteGrid::may_drill(int place, int net) const {
  if (!is_allowed(via_[at(place)], net)) return false;
  return kinds_[at(net)] == NetKind::kSensor ? window_[at(place)] == 2 : window_[at(place)] == 0;
}

Vec2 RouteGrid::place_mm(int index) const {
  const int node = index % nodes_per_layer();
  return {kGridPitch_mm * (node % width_) - design::kSide_mm / 2.0, kGridPitch_mm * (node / width_) - kGridInradius_mm};
}

// The layer of the rings is free only inside the innermost one, where no corner cut moves a ring, and so are the holes,
// which go through that layer.
void RouteGrid::block_edges() {
  constexpr double kInnermost_mm = kContacts.back().inset_mm + kNarrowTrack_mm / 2.0 + kClearance_mm;
  for (int place = 0; place < nodes_per_layer(); ++place) {
    const Vec2 p = place_mm(place);
    const double inset = inset_of_mm(p);
    const bool is_at_edge = std::min(inset, from_cut_mm(p)) < kEdgeClearance_mm + kHalfTrack_mm;
    for (int layer = 0; layer < kCopperLayers; ++layer) {
      if (is_at_edge || (layer == kFront && inset < kShieldInset_mm + kSensorGap_mm) ||
          (layer == kRingLayer && inset < kInnermost_mm + kHalfTrack_mm))
        track_[at(layer * nodes_per_layer() + place)] = kNobody;
    }
    if (inset < kInnermost_mm + kViaRadius_mm) via_[at(place)] = kNobody;
  }
}

template <typename Use>
void RouteGrid::for_nodes_near(const FixedCopper& copper, double reach_mm, Use use) const {
  const double size = copper.radius_mm + copper.half_size_mm.norm() + reach_mm;
  const Vec2 origin(-design::kSide_mm / 2.0, -kGridInradius_mm);
  const Vec2 low =
      (copper.from_mm.cwiseMin(copper.to_mm) - origin) / kGridPitch_mm - Vec2::Constant(size / kGridPitch_mm);
  const Vec2 high =
      (copper.from_mm.cwiseMax(copper.to_mm) - origin) / kGridPitch_mm + Vec2::Constant(size / kGridPitch_mm);
  for (int y = std::max(0, static_cast<int>(low.y())); y <= std::min(height_ - 1, static_cast<int>(high.y()) + 1);
       ++y) {
    for (int x = std::max(0, static_cast<int>(low.x())); x <= std::min(width_ - 1, static_cast<int>(high.x()) + 1);
         ++x) {
      const int place = index({0, x, y});
      if (copper.distance_mm(place_mm(place)) < reach_mm) use(place);
    }
  }
}

void RouteGrid::block_copper(const FixedCopper& copper) {
  for_nodes_near(copper, kClearance_mm + kHalfTrack_mm, [&](int place) {
    for (int layer = kShieldLayer; layer < kCopperLayers; ++layer) {
      if (copper.on[at(layer)]) claim(track_[at(layer * nodes_per_layer() + place)], copper.net);
    }
  });
  if (copper.on[kFront])
    for_nodes_near(copper, kFrontGap_mm + kHalfTrack_mm, [&](int place) { claim(track_[at(place)], copper.net); });
  for_nodes_near(copper, kClearance_mm + kViaRadius_mm, [&](int place) { claim(via_[at(place)], copper.net); });
  const bool is_hole = std::ranges::all_of(copper.on, [](bool on) { return on; });
  // A hole in a pad on the back would draw the solder off; the chip's wide pad is meant to have some.
  const bool is_soldered = !copper.on[kFront] && copper.half_size_mm.x() > 0.0 && copper.half_size_mm.x() < 1.0;
  const double reach_mm = is_hole ? kHoleGap_mm + kContactHole_mm / 2.0 : kViaRadius_mm;
  if (is_hole || is_soldered) for_nodes_near(copper, reach_mm, [&](int place) { via_[at(place)] = kNobody; });
}

std::vector<int> RouteGrid::nodes_in(const FixedCopper& copper) const {
  constexpr double kInside_mm = 0.02;  // An end on the very border of a pad may be read as beside it.
  FixedCopper inside = copper;
  inside.radius_mm = std::max(0.0, copper.radius_mm - kInside_mm);
  if (copper.half_size_mm.x() > 0.0) inside.half_size_mm -= Vec2::Constant(kInside_mm);
  std::vector<int> nodes;
  for_nodes_near(inside, 1e-9, [&](int place) {
    for (int layer = 0; layer < kCopperLayers; ++layer) {
      if (copper.on[at(layer)]) nodes.push_back(layer * nodes_per_layer() + place);
    }
  });
  return nodes;
}

}  // namespace triskin::fabrication

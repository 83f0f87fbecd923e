// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/lattice/what_refuses.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "grower.hpp"
#include "triskin/design/tile.hpp"

namespace triskin::lattice {
namespace {

constexpr int kPlaces = 8;
constexpr int kDirections = 12;
constexpr double kReach_mm = 10.0;  // Curvature is measured over this distance, the size of a module and not of a face.
constexpr double kNearPlace_mm = 5.0;  // A module that covers this much beside the place has found room.

// Curvatures of the normal sections at a point, 1/mm; positive if the surface bends away from its normal.
struct Bend {
  double mean = 0.0, largest = 0.0, least = 0.0;
};

Bend bend_at(const mesh::Surface& surface, const Vec3& place) {
  const mesh::SurfacePoint here = surface.closest(place);
  const Vec3 n = surface.normal_at(here), x = n.unitOrthogonal(), y = n.cross(x);
  Bend bend{0.0, -1e300, 1e300};
  for (int k = 0; k < kDirections; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / kDirections;
    const mesh::SurfacePoint there = surface.closest(place + kReach_mm * (std::cos(angle) * x + std::sin(angle) * y));
    const Vec3 way = there.position_mm - here.position_mm, turn = surface.normal_at(there) - n;
    const double length = way.norm();
    if (length < 1.0) continue;  // The border or a fold is so near that there is no direction to measure in.
    const double curvature = way.dot(turn) / (length * length);
    bend.mean += curvature / kDirections;
    bend.largest = std::max(bend.largest, curvature);
    bend.least = std::min(bend.least, curvature);
  }
  return bend;
}

// Gives the quantity that a limit bounds, for a surface with these curvatures (docs/limits.md), and its limit. It
// grows with the curvature, or for the edge error with its square.
struct Demand {
  double is_mm = 0.0, allowed_mm = 0.0, power = 1.0;
};
Demand demand_of(const std::string& limit, const Bend& bend, const LayoutLimits& limits, double lift_mm) {
  const double sharpest = std::max(std::abs(bend.largest), std::abs(bend.least));
  const double square = design::kSide_mm * design::kSide_mm;
  if (limit == "center_gap_mm") return {square * std::abs(bend.mean) / 6.0, limits.center_gap_mm + lift_mm, 1.0};
  if (limit == "lift_mm") return {square * std::abs(bend.least) / 8.0, limits.lift_mm, 1.0};
  if (limit == "depth_mm") return {square * std::abs(bend.largest) / 8.0, limits.depth_mm, 1.0};
  if (limit == "edge_error_mm")
    return {square * design::kSide_mm * sharpest * sharpest / 24.0, limits.edge_error_mm, 2.0};
  return {};
}

void add_radius(Obstacle& o, const mesh::Surface& surface, const LayoutLimits& limits, double lift_mm) {
  const Bend bend = bend_at(surface, o.place_mm);
  const double sharpest = std::max(std::abs(bend.largest), std::abs(bend.least));
  const Demand demand = demand_of(o.limit, bend, limits, lift_mm);
  if (demand.allowed_mm <= 0.0 || demand.is_mm <= demand.allowed_mm || sharpest <= 0.0) return;
  o.radius_mm = 1.0 / sharpest;
  o.needed_radius_mm = o.radius_mm * std::pow(demand.is_mm / demand.allowed_mm, 1.0 / demand.power);
  o.needed_limit_mm = demand.is_mm - (o.limit == "center_gap_mm" ? lift_mm : 0.0);
}

// Returns twice the greatest distance to the border, and its place, among corners and middles of faces.
std::pair<double, Vec3> widest_mm(const mesh::Surface& surface) {
  std::pair<double, Vec3> widest{0.0, Vec3::Zero()};
  const auto offer = [&](const Vec3& p) {
    if (const double width = 2.0 * surface.border_distance(p); width > widest.first) widest = {width, p};
  };
  for (const Vec3& v : surface.mesh().vertices) offer(v);
  for (const auto& f : surface.mesh().faces) {
    const auto corner = [&](std::size_t k) { return surface.mesh().vertices[static_cast<std::size_t>(f[k])]; };
    offer((corner(0) + corner(1) + corner(2)) / 3.0);
    for (std::size_t k = 0; k < 3; ++k) offer((corner(k) + corner((k + 1) % 3)) / 2.0);
  }
  return widest;
}

}  // namespace

std::optional<Obstacle> what_refuses(const mesh::Surface& surface, const LayoutLimits& limits,
                                     const SurfaceLatticeOptions& options) {
  const double needed_mm = design::kHeight_mm - 2.0 * limits.overrun_mm;
  if (const auto [width, place] = widest_mm(surface); width < needed_mm)
    return Obstacle{"narrow", 1, 1, place, width, 0.0, 0.0, 0.0};
  std::map<std::string, std::vector<Vec3>> refused;
  const auto samples = spread_samples(surface, surface.area_mm2() / kPlaces, options.seed);
  const auto tried = static_cast<int>(std::min<std::size_t>(samples.size(), kPlaces));
  for (int k = 0; k < tried; ++k) {
    const Vec3& place = samples[static_cast<std::size_t>(k)].point;
    const std::string why = why_uncovered(surface, limits, options, place, kNearPlace_mm);
    if (why == "room") return std::nullopt;
    refused[why].push_back(place);
  }
  if (refused.empty()) return std::nullopt;
  const auto& [limit, places] =
      *std::ranges::max_element(refused, {}, [](const auto& entry) { return entry.second.size(); });
  Obstacle best;
  for (const Vec3& place : places) {
    Obstacle o{limit, static_cast<int>(places.size()), tried, place, 0.0, 0.0, 0.0, 0.0};
    add_radius(o, surface, limits, corner_lift_of(limits, options));
    const bool nearer =
        o.needed_limit_mm > 0.0 && (best.needed_limit_mm == 0.0 || o.needed_limit_mm < best.needed_limit_mm);
    if (best.limit.empty() || nearer) best = o;
  }
  return best;
}

}  // namespace triskin::lattice

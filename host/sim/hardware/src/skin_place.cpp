// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/skin_place.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "triskin/geometry/triangle.hpp"

namespace triskin::hardware {
namespace {

using design::Vec3;
using geometry::Triangle;

}  // namespace

std::optional<SkinPlace> nearest_place(const design::Design& design, const Vec3& point_mm) {
  std::optional<SkinPlace> best;
  for (std::size_t m = 0; m < design.layout.modules.size(); ++m) {
    const Vec3 at = geometry::closest_point_on_triangle(point_mm, design.layout.modules[m].corner_mm);
    const double distance_mm = (at - point_mm).norm();
    if (!best || distance_mm < best->distance_mm) best = SkinPlace{at, layout::ModuleId{m}, distance_mm};
  }
  return best;
}

std::optional<SkinPlace> place_on_ray(const design::Design& design, const Vec3& from_mm, const Vec3& direction) {
  if (!(direction.norm() > 0.0)) return std::nullopt;
  const Vec3 along = direction.normalized();
  std::optional<SkinPlace> best;
  // A ray that hits a module also passes near its neighbours, where it must not look like one that passes through a
  // gap.
  constexpr double kPenaltyBeside = 10.0;
  double best_mm = 0.0;
  for (std::size_t m = 0; m < design.layout.modules.size(); ++m) {
    const Triangle& t = design.layout.modules[m].corner_mm;
    const Vec3 normal = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
    const double steepness = normal.dot(along);
    if (std::abs(steepness) < 1e-9) continue;
    const double way_mm = normal.dot(t[0] - from_mm) / steepness;
    if (way_mm < 0.0) continue;
    const Vec3 crossing = from_mm + way_mm * along, at = geometry::closest_point_on_triangle(crossing, t);
    const double beside_mm = (at - crossing).norm();
    const double score_mm = way_mm + kPenaltyBeside * beside_mm;
    if (beside_mm > kMaxGap_mm || (best && score_mm >= best_mm)) continue;
    best = SkinPlace{at, layout::ModuleId{m}, beside_mm};
    best_mm = score_mm;
  }
  return best;
}

}  // namespace triskin::hardware

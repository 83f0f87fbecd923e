// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "body_overlap.hpp"
#include "fold_limit.hpp"
#include "overlapping_pairs.hpp"
#include "overrun.hpp"
#include "point_grid.hpp"
#include "rigid.hpp"
#include "triskin/base/index.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/lattice/map_modules.hpp"

namespace triskin::lattice {
namespace {

// Modules with centroids farther apart than two circumradii and some height cannot touch.
constexpr double kNear_mm = 45.0;
constexpr double kLayer_mm = 10.0;    // Modules this far apart along the normal lie on different sheets.
constexpr double kSideStep_mm = 0.5;  // docs/design_file.md defines the metrics with this step.

Vec3 centroid_of(const std::array<Vec3, 3>& t) {
  return (t[0] + t[1] + t[2]) / 3.0;
}

double angle_between(const Vec3& a, const Vec3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// Returns the smallest overlap of the two projected outlines over the directions normal to their sides (separating
// axes).
template <std::size_t N>
double planar_depth(const std::array<Vec2, N>& a, const std::array<Vec2, N>& b) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto* t : {&a, &b}) {
    for (std::size_t k = 0; k < N; ++k) {
      const Vec2 d = ((*t)[(k + 1) % N] - (*t)[k]).normalized();
      const Vec2 n(d.y(), -d.x());
      double a_low = 1e300, a_high = -1e300, b_low = 1e300, b_high = -1e300;
      for (std::size_t c = 0; c < N; ++c) {
        a_low = std::min(a_low, n.dot(a[c]));
        a_high = std::max(a_high, n.dot(a[c]));
        b_low = std::min(b_low, n.dot(b[c]));
        b_high = std::max(b_high, n.dot(b[c]));
      }
      least = std::min({least, a_high - b_low, b_high - a_low});
      if (least <= 0.0) return 0.0;
    }
  }
  return least;
}

// Normals at corners and centre turn by the curvature times the distance.
double smallest_radius(const mesh::Surface& surface, const std::array<Vec3, 3>& corners) {
  const Vec3 middle = centroid_of(corners);
  const Vec3 n = surface.normal_at(surface.closest(middle));
  double largest_turn = 0.0;
  for (const Vec3& c : corners)
    largest_turn = std::max(largest_turn, angle_between(n, surface.normal_at(surface.closest(c))));
  return largest_turn > 1e-6 ? (corners[0] - middle).norm() / largest_turn : 0.0;
}

void measure_joint(const std::vector<PlacedModule>& modules, PlacedModule& m, int s) {
  m.hinge_gap_mm[at(s)] = m.fold_rad[at(s)] = 0.0;
  if (m.neighbour[at(s)] < 0) return;
  const PlacedModule& other = modules[at(m.neighbour[at(s)])];
  const int t = across(m.tile, s).side;
  const Vec3 &a = m.corner_mm[at(s)], &b = m.corner_mm[at((s + 1) % 3)], &c = other.corner_mm[at((t + 1) % 3)],
             &d = other.corner_mm[at(t)];
  m.hinge_gap_mm[at(s)] = std::max((a - c).norm(), (b - d).norm());
  m.fold_rad[at(s)] = angle_between(normal_of(m.corner_mm), normal_of(other.corner_mm));
  // The net's edge connects the mean places of its ends, which two rigid sides share.
  m.edge_error_mm = std::max(m.edge_error_mm, std::abs((0.5 * (b + d) - 0.5 * (a + c)).norm() - kSide_mm));
}

}  // namespace

double penetration_depth(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b, double corner_cut_mm) {
  const Vec3 ca = centroid_of(a), cb = centroid_of(b);
  if ((ca - cb).norm() > kNear_mm) return 0.0;
  const Vec3 na = normal_of(a), nb = normal_of(b);
  if (na.dot(nb) < kBodiesBelow) return body_overlap_mm(a, b, corner_cut_mm);
  const Vec3 n = (na + nb).normalized();
  if (std::abs(n.dot(ca - cb)) > kLayer_mm) return 0.0;
  const Vec3 x = (a[1] - a[0] - n.dot(a[1] - a[0]) * n).normalized(), y = n.cross(x);
  const auto flat = [&](const std::array<Vec3, 3>& t) {
    return std::array{Vec2(x.dot(t[0]), y.dot(t[0])), Vec2(x.dot(t[1]), y.dot(t[1])), Vec2(x.dot(t[2]), y.dot(t[2]))};
  };
  const double whole = planar_depth(flat(a), flat(b));
  if (corner_cut_mm <= 0.0 || whole <= 0.0) return whole;
  const auto flat_outline = [&](const std::array<Vec3, 3>& t) {
    const design::Outline o = design::outline_of(t, corner_cut_mm);
    std::array<Vec2, 6> points;
    for (std::size_t k = 0; k < 6; ++k) points[k] = {x.dot(o.point[k]), y.dot(o.point[k])};
    return points;
  };
  return planar_depth(flat_outline(a), flat_outline(b));
}

void measure_on_surface(const mesh::Surface& surface, PlacedModule& m, double corner_cut_mm,
                        const mesh::SurfaceRegions* regions) {
  const design::Outline outline = design::outline_of(m.corner_mm, corner_cut_mm);
  m.center_gap_mm = surface.closest(centroid_of(m.corner_mm)).distance_mm;
  const SideHeights sides = walk_sides(surface, outline, kSideStep_mm);
  m.edge_lift_mm = sides.lift_mm;
  m.edge_depth_mm = sides.depth_mm;
  m.overrun_mm = overrun_of(surface, outline).mm;
  m.keep_out_mm = regions == nullptr ? 0.0 : regions->keep_out_mm(m.corner_mm, corner_cut_mm);
  m.bend_radius_mm = smallest_radius(surface, m.corner_mm);
}

std::vector<OverlappingPair> overlapping_pairs(const ModuleLayout& layout) {
  const auto& modules = layout.modules;
  std::vector<Vec3> middles;
  for (const PlacedModule& m : modules) middles.push_back(centroid_of(m.corner_mm));
  lattice::PointGrid grid(middles, kNear_mm);
  std::vector<OverlappingPair> pairs;
  for (std::size_t b = 0; b < modules.size(); ++b) {
    (void)grid.any_near(middles[b], kNear_mm, [&](int a) {
      const double depth_mm = penetration_depth(modules[at(a)].corner_mm, modules[b].corner_mm, layout.corner_cut_mm);
      if (depth_mm > 0.0) pairs.push_back({a, static_cast<int>(b), depth_mm});
      return false;
    });
    grid.add(static_cast<int>(b), middles[b]);
  }
  return pairs;
}

void measure_between(ModuleLayout& layout, const std::vector<OverlappingPair>& pairs) {
  auto& modules = layout.modules;
  for (PlacedModule& m : modules) {
    m.penetration_mm = 0.0;
    m.edge_error_mm = 0.0;
    for (int s = 0; s < 3; ++s) measure_joint(modules, m, s);
  }
  for (const auto& [a, b, depth_mm] : pairs) {
    for (const int k : {a, b}) modules[at(k)].penetration_mm = std::max(modules[at(k)].penetration_mm, depth_mm);
  }
}

void measure_between(ModuleLayout& layout) {
  measure_between(layout, overlapping_pairs(layout));
}

void measure(const mesh::Surface& surface, ModuleLayout& layout, const mesh::SurfaceRegions* regions) {
  for (PlacedModule& m : layout.modules) measure_on_surface(surface, m, layout.corner_cut_mm, regions);
  measure_between(layout);
}

}  // namespace triskin::lattice

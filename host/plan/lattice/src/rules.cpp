// SPDX-License-Identifier: GPL-3.0-or-later
#include "rules.hpp"

#include <algorithm>
#include <cmath>

#include "body_overlap.hpp"
#include "fold_limit.hpp"
#include "overlap.hpp"
#include "overrun.hpp"
#include "triskin/design/outline.hpp"

namespace triskin::lattice {
namespace {

constexpr double kMargin = 0.97;  // An independent measurement must agree, so we keep 3 % away from the limits.
// Lift and depth need less margin because the checker walks the sides in the same way.
constexpr double kSidesMargin = 0.995;
constexpr double kStep_mm = 1.5;          // We walk along a side near the border in steps of this length.
constexpr double kSideStep_mm = 0.5;      // The final measurement of lift and depth uses the same step along a side.
constexpr double kOverrunStep_mm = 0.02;  // The largest overrun of a line is found with this accuracy.
constexpr int kSideParts = 4;
constexpr double kClear_mm = 5.0;  // A point farther from the border than a module may stand off does not overhang it.
// A module whose centre is farther from the border does not extend over it.
constexpr double kBorderFar_mm = 2.0 * kHeight_mm / 3.0 + kClear_mm;
constexpr double kOutward = 0.6;  // The cosine is between module and surface.
// Probes are this far apart along the border, and beyond it at this multiple of the limit.
constexpr double kProbeStep_mm = 1.0, kProbeOut = 1.01;
constexpr double kProbeHeight_mm = 8.0;
// We use 70 % of the room: the height changes by as much as a side moves, and its normal turns.
constexpr double kSafeMove = 0.7;

LayoutLimits with_margin(LayoutLimits l) {
  for (double* v : {&l.edge_error_mm, &l.hinge_gap_mm, &l.center_gap_mm, &l.fold_rad, &l.penetration_mm, &l.overrun_mm,
                    &l.fold_away_rad, &l.fold_towards_rad})
    *v *= kMargin;
  for (double* v : {&l.lift_mm, &l.depth_mm}) *v *= kSidesMargin;
  return l;
}

Vec3 corner_at(const LatticeMesh& net, int triangle, int vertex) {
  const NetTriangle& t = net.triangles()[at(triangle)];
  return t.vertex[0] == vertex ? t.rigid[0] : t.vertex[1] == vertex ? t.rigid[1] : t.rigid[2];
}

// Returns true if a point over the whole triangle lies in a corner that is cut off.
bool in_cut_corner(const NetTriangle& t, const Vec3& p) {
  constexpr double kCircumradius_mm = 2.0 * kHeight_mm / 3.0;
  const double limit = kCircumradius_mm * design::short_side_offset_mm(t.corner_cut_mm);
  return std::ranges::any_of(t.rigid,
                             [&](const Vec3& corner) { return (corner - t.center).dot(p - t.center) > limit; });
}

// Returns true for a point over the module, seen along its normal and near its plane.
bool covers(const NetTriangle& t, const Vec3& p) {
  const Vec3 d = p - t.center;
  if (d.squaredNorm() > kModuleReach_mm * kModuleReach_mm || std::abs(d.dot(t.normal)) > kProbeHeight_mm) return false;
  return lies_over(t, p) && (t.corner_cut_mm <= 0.0 || !in_cut_corner(t, p));
}

}  // namespace

const char* name_of(Refusal refusal) {
  static constexpr std::array kNames{"none",          "edge_error_mm", "hinge_gap_mm",   "fold_rad",
                                     "center_gap_mm", "outward",       "penetration_mm", "overrun_mm",
                                     "lift_mm",       "depth_mm",      "keep_out"};
  return kNames[static_cast<std::size_t>(refusal)];
}

Rules::Rules(const mesh::Surface& surface, const LayoutLimits& limits, const std::vector<Vec3>& free_points)
    : limits_(with_margin(limits)),
      fold_cosine_(std::cos(limits_.fold_rad)),
      has_directed_folds_(std::min(limits_.fold_away_rad, limits_.fold_towards_rad) < limits_.fold_rad),
      probe_grid_(surface.mesh().vertices, kModuleReach_mm),
      free_points_(free_points),
      free_grid_(free_points, kModuleReach_mm) {
  for (std::size_t k = 0; k < free_points_.size(); ++k) free_grid_.add(static_cast<int>(k), free_points_[k]);
  const Mesh& mesh = surface.mesh();
  for (FaceIndex f{0}; f < static_cast<int>(mesh.faces.size()); ++f) {
    for (int s = 0; s < 3; ++s) {
      if (surface.neighbours(f)[at(s)] >= 0) continue;
      const Vec3 &a = mesh.vertices[at(mesh.faces[at(f)][at(s)])],
                 &b = mesh.vertices[at(mesh.faces[at(f)][at((s + 1) % 3)])];
      const Vec3 out = (b - a).cross(surface.face_normal(f)).normalized() * kProbeOut * limits_.overrun_mm;
      const int parts = static_cast<int>(std::ceil((b - a).norm() / kProbeStep_mm));
      for (int k = 0; k < parts; ++k) {
        const Vec3 p = a + (b - a) * ((k + 0.5) / parts) + out;
        if (surface.closest(p).distance_mm <= limits_.overrun_mm) continue;
        probe_grid_.add(static_cast<int>(probes_.size()), p);
        probes_.push_back(p);
      }
    }
  }
}

Refusal Rules::evaluate(NearSurface& surface, const LatticeMesh& net, const std::vector<int>& triangles,
                        std::vector<Pair>& pairs, std::vector<KnownSides>& known) const {
  for (const int t : triangles) {
    if (const Refusal r = evaluate_joints(net, t); r != Refusal::kNone) return r;
  }
  for (Pair& pair : pairs) {
    if (overlap(net.triangles()[at(pair.a)], net.triangles()[at(pair.b)], pair.axis)) return Refusal::kPenetration;
  }
  for (const int t : triangles) {
    const NetTriangle& triangle = net.triangles()[at(t)];
    const Foot under = surface.closest(triangle.center);
    if (under.distance_mm > limits_.center_gap_mm) return Refusal::kCenterGap;
    if (under.normal.dot(triangle.normal) < kOutward) return Refusal::kOutward;
  }
  if (std::ranges::any_of(triangles, [&](int t) { return over_border(surface, net, t); })) return Refusal::kOverrun;
  const auto is_over_free = [&](int t) {
    const NetTriangle& triangle = net.triangles()[at(t)];
    return free_grid_.any_near(triangle.center, kModuleReach_mm,
                               [&](int k) { return covers(triangle, free_points_[at(k)]); });
  };
  if (!free_points_.empty() && std::ranges::any_of(triangles, is_over_free)) return Refusal::kKeepOut;
  if (known.size() < net.triangles().size()) known.resize(net.triangles().size());
  for (const int t : triangles) {
    const Refusal r = evaluate_sides(surface, net.triangles()[at(t)], known[at(t)]);
    if (r != Refusal::kNone) return r;
  }
  return Refusal::kNone;
}

Refusal Rules::evaluate_joints(const LatticeMesh& net, int triangle) const {
  const NetTriangle& t = net.triangles()[at(triangle)];
  for (int s = 0; s < 3; ++s) {
    const int other = net.neighbour(triangle, s);
    if (other < 0) continue;
    const Vec3 a = corner_at(net, other, t.vertex[at(s)]), b = corner_at(net, other, t.vertex[at((s + 1) % 3)]);
    const Vec3 &c = t.rigid[at(s)], &d = t.rigid[at((s + 1) % 3)];
    if (std::max((a - c).norm(), (b - d).norm()) > limits_.hinge_gap_mm) return Refusal::kHingeGap;
    if (std::abs(0.5 * (b + d - a - c).norm() - kSide_mm) > limits_.edge_error_mm) return Refusal::kEdgeError;
    const Vec3& n = net.triangles()[at(other)].normal;
    if (n.dot(t.normal) < fold_cosine_) return Refusal::kFold;
    if (has_directed_folds_ && n.dot(t.normal) < std::cos(fold_limit_between(limits_, t.normal, n, d - c)))
      return Refusal::kFold;
    int axis = 0;
    const double depth_mm = n.dot(t.normal) < kBodiesBelow
                                ? body_overlap_mm(t.rigid, net.triangles()[at(other)].rigid, t.corner_cut_mm)
                                : overlap_of(t, net.triangles()[at(other)], axis).depth_mm;
    if (depth_mm > limits_.penetration_mm) return Refusal::kPenetration;
  }
  return Refusal::kNone;
}

// Walks lift and depth along the sides, as in the final measurement, with large steps at points far from both limits.
Refusal Rules::evaluate_sides(NearSurface& surface, const NetTriangle& t, KnownSides& known) const {
  double moved = 0.0;
  for (std::size_t k = 0; k < 3; ++k) moved = std::max(moved, (t.rigid[k] - known.rigid[k]).squaredNorm());
  if (moved <= kSafeMove * kSafeMove * known.room_mm * known.room_mm) return Refusal::kNone;
  const design::Outline outline = design::outline_of(t.rigid, t.corner_cut_mm);
  double min_room = std::min(limits_.lift_mm, limits_.depth_mm);
  for (std::size_t s = 0; s < outline.size; ++s) {
    const Vec3& from = outline.point[s];
    const Vec3 side = outline.point[(s + 1) % outline.size] - from;
    const double length_mm = side.norm();
    for (double x = 0.0; x < length_mm;) {
      const Vec3 p = from + x / length_mm * side;
      const Foot foot = surface.closest(p);
      const double height = (p - foot.point).dot(foot.normal);
      const double room = std::min(limits_.lift_mm - height, limits_.depth_mm + height);
      if (room < 0.0) return height > 0.0 ? Refusal::kLift : Refusal::kDepth;
      min_room = std::min(min_room, room);
      x += std::max(kSideStep_mm, kSafeMove * room);
    }
  }
  known = {t.rigid, min_room};
  return Refusal::kNone;
}

bool Rules::exceeds_overrun(NearSurface& surface, const NetTriangle& t) const {
  if (surface.border_at_least(t.center) >= kBorderFar_mm) return false;
  const design::Outline outline = design::outline_of(t.rigid, t.corner_cut_mm);
  for (std::size_t s = 0; s < outline.size; ++s) {
    const Vec3& from = outline.point[s];
    const Vec3 part = (outline.point[(s + 1) % outline.size] - from) / kSideParts;
    for (int k = 0; k < kSideParts; ++k) {
      const Vec3 a = from + k * part;
      if (surface.border_at_least(a + 0.5 * part) >= kClear_mm + 0.5 * kSide_mm / kSideParts) continue;
      if (overrun_of_line(surface.surface(), a, a + part, limits_.overrun_mm - kOverrunStep_mm).mm > limits_.overrun_mm)
        return true;
    }
  }
  return false;
}

// A plane that separates the outlines separates the modules in space too; otherwise both measures have to agree.
bool Rules::overlap(const NetTriangle& a, const NetTriangle& b, int& axis) const {
  if (a.normal.dot(b.normal) < kBodiesBelow)
    return body_overlap_mm(a.rigid, b.rigid, a.corner_cut_mm) > limits_.penetration_mm ||
           pierced(a.rigid, b.rigid, a.corner_cut_mm, limits_.penetration_mm);
  if ((a.center - b.center).squaredNorm() > 16.0 / 9.0 * kHeight_mm * kHeight_mm) return false;
  const Overlap o = overlap_of(a, b, axis);
  return o.depth_mm > limits_.penetration_mm ||
         (!(o.apart_mm > 0.0) && pierced(a.rigid, b.rigid, a.corner_cut_mm, limits_.penetration_mm));
}

bool Rules::over_border(NearSurface& surface, const LatticeMesh& net, int triangle) const {
  const NetTriangle& t = net.triangles()[at(triangle)];
  if (surface.border_at_least(t.center) >= kBorderFar_mm) return false;
  for (std::size_t s = 0; s < 3; ++s) {
    // A notch under a joined side opens under a free one or is found by the probes.
    const bool is_free = net.neighbour(triangle, static_cast<int>(s)) < 0;
    if (t.corner_cut_mm > 0.0 ? cut_sides_over_border(surface, t, s, is_free)
                              : is_free && side_over_border(surface, t.rigid[s], t.rigid[(s + 1) % 3], kSide_mm))
      return true;
  }
  return probe_grid_.any_near(t.center, kModuleReach_mm, [&](int k) { return covers(t, probes_[at(k)]); });
}

// Tests the long side s, if it is free, and the short one at its end: a hole may lie where the cut corners of several
// modules meet.
bool Rules::cut_sides_over_border(NearSurface& surface, const NetTriangle& t, std::size_t s, bool is_free) const {
  const design::Outline outline = design::outline_of(t.rigid, t.corner_cut_mm);
  const Vec3 &from = outline.point[2 * s], &to = outline.point[2 * s + 1], &next = outline.point[(2 * s + 2) % 6];
  return (is_free && side_over_border(surface, from, to, kSide_mm - 2.0 * t.corner_cut_mm)) ||
         side_over_border(surface, to, next, t.corner_cut_mm);
}

bool Rules::side_over_border(NearSurface& surface, const Vec3& from, const Vec3& to, double length_mm) const {
  const Vec3 d = (to - from) / length_mm;
  for (double x = 0.0; x <= length_mm;) {
    const Vec3 p = from + x * d;
    const double border = surface.border_at_least(p);
    if (border < kClear_mm && surface.may_be_over_border(p)) {
      const Foot foot = surface.closest(p);
      const Vec3 off = p - foot.point;
      if (foot.on_border && (off - off.dot(foot.normal) * foot.normal).norm() > limits_.overrun_mm) return true;
    }
    x += std::max(kStep_mm, border - kClear_mm);
  }
  return false;
}

}  // namespace triskin::lattice

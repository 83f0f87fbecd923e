// SPDX-License-Identifier: GPL-3.0-or-later
#include "rules.hpp"

#include <algorithm>
#include <cmath>

#include "overlap.hpp"

namespace triskin::geometry::surface_lattice {
namespace {

constexpr double kMargin = 0.97;       // an independent measurement must agree
constexpr double kStep_mm = 1.5;       // of the walk along a side; the end result is measured every 0.5 mm
constexpr double kClear_mm = 5.0;      // a point farther from the border than a module may stand off is not over it
constexpr double kOutward = 0.6;       // cosine between module and surface
constexpr double kProbeStep_mm = 2.0;
constexpr double kProbeHeight_mm = 8.0;

LayoutLimits with_margin(LayoutLimits l) {
  for (double* v : {&l.edge_error_mm, &l.hinge_gap_mm, &l.center_gap_mm, &l.fold_rad, &l.penetration_mm, &l.overrun_mm}) *v *= kMargin;
  return l;
}

Vec3 corner_at(const LatticeNet& net, int triangle, int vertex) {
  const NetTriangle& t = net.triangles[at(triangle)];
  return t.vertex[0] == vertex ? t.rigid[0] : t.vertex[1] == vertex ? t.rigid[1] : t.rigid[2];
}

// Seen along the module's normal, and near its plane.
bool covers(const NetTriangle& t, const Vec3& p) {
  const Vec3 d = p - t.center;
  if (d.squaredNorm() > 400.0 || std::abs(d.dot(t.normal)) > kProbeHeight_mm) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    if (t.normal.cross(t.rigid[(k + 1) % 3] - t.rigid[k]).dot(p - t.rigid[k]) < 0) return false;
  }
  return true;
}

}  // namespace

const char* name_of(Refusal refusal) {
  static constexpr std::array kNames{"none", "edge_error_mm", "hinge_gap_mm", "fold_rad", "center_gap_mm", "outward", "penetration_mm", "overrun_mm"};
  return kNames[static_cast<std::size_t>(refusal)];
}

Rules::Rules(const Surface& surface, const LayoutLimits& limits) : surface_(surface), limits_(with_margin(limits)) {
  const Mesh& mesh = surface.mesh();
  for (int f = 0; f < static_cast<int>(mesh.faces.size()); ++f) {
    for (int s = 0; s < 3; ++s) {
      if (surface.neighbours(f)[at(s)] >= 0) continue;
      const Vec3 &a = mesh.vertices[at(mesh.faces[at(f)][at(s)])], &b = mesh.vertices[at(mesh.faces[at(f)][at((s + 1) % 3)])];
      const Vec3 out = (b - a).cross(surface.face_normal(f)).normalized() * 1.02 * limits.overrun_mm;
      const int parts = static_cast<int>(std::ceil((b - a).norm() / kProbeStep_mm));
      for (int k = 0; k < parts; ++k) {
        const Vec3 p = a + (b - a) * ((k + 0.5) / parts) + out;
        if (surface.closest(p).distance_mm > limits.overrun_mm) probes_.push_back(p);
      }
    }
  }
}

Refusal Rules::judge(const LatticeNet& net, int triangle) const {
  const NetTriangle& t = net.triangles[at(triangle)];
  if (const Refusal r = judge_joints(net, triangle); r != Refusal::kNone) return r;
  const SurfacePoint under = surface_.closest(t.center);
  if (under.distance_mm > limits_.center_gap_mm) return Refusal::kCenterGap;
  if (surface_.normal_at(under).dot(t.normal) < kOutward) return Refusal::kOutward;
  if (overlaps(net, triangle)) return Refusal::kPenetration;
  return over_border(net, triangle) ? Refusal::kOverrun : Refusal::kNone;
}

Refusal Rules::judge_joints(const LatticeNet& net, int triangle) const {
  const NetTriangle& t = net.triangles[at(triangle)];
  for (int s = 0; s < 3; ++s) {
    const int other = net.neighbour(triangle, s);
    if (other < 0) continue;
    const Vec3 a = corner_at(net, other, t.vertex[at(s)]), b = corner_at(net, other, t.vertex[at((s + 1) % 3)]);
    const Vec3 &c = t.rigid[at(s)], &d = t.rigid[at((s + 1) % 3)];
    if (std::max((a - c).norm(), (b - d).norm()) > limits_.hinge_gap_mm) return Refusal::kHingeGap;
    if (std::abs(0.5 * (b + d - a - c).norm() - kSide_mm) > limits_.edge_error_mm) return Refusal::kEdgeError;
    const Vec3& n = net.triangles[at(other)].normal;
    if (std::atan2(n.cross(t.normal).norm(), n.dot(t.normal)) > limits_.fold_rad) return Refusal::kFold;
  }
  return Refusal::kNone;
}

bool Rules::overlaps(const LatticeNet& net, int triangle) const {
  const NetTriangle& t = net.triangles[at(triangle)];
  for (int k = 0; k < static_cast<int>(net.triangles.size()); ++k) {
    const NetTriangle& other = net.triangles[at(k)];
    if (k == triangle || other.island < 0 || (other.center - t.center).squaredNorm() > 45.0 * 45.0) continue;
    if (overlap_of(t, other).depth_mm > limits_.penetration_mm || pierced(t, other, limits_.penetration_mm)) return true;
  }
  return false;
}

bool Rules::over_border(const LatticeNet& net, int triangle) const {
  const NetTriangle& t = net.triangles[at(triangle)];
  if (surface_.border_distance(t.center) > 2.0 * kHeight_mm / 3.0 + kClear_mm) return false;
  for (std::size_t s = 0; s < 3; ++s) {
    // A notch under a joined side opens under a free one or is met by the probes.
    if (net.neighbour(triangle, static_cast<int>(s)) < 0 && side_over_border(t.rigid[s], t.rigid[(s + 1) % 3])) return true;
  }
  return std::ranges::any_of(probes_, [&](const Vec3& p) { return covers(t, p); });
}

bool Rules::side_over_border(const Vec3& from, const Vec3& to) const {
  const Vec3 d = (to - from).normalized();
  for (double x = 0.0; x <= kSide_mm;) {
    const Vec3 p = from + x * d;
    const double border = surface_.border_distance(p);
    if (border < kClear_mm && border > limits_.overrun_mm) {
      const SurfacePoint c = surface_.closest(p);
      const Vec3 off = p - c.position_mm, n = surface_.normal_at(c);
      if ((off - off.dot(n) * n).norm() > limits_.overrun_mm && surface_.border_distance(c.position_mm) < 1e-6) return true;
    }
    x += std::max(kStep_mm, border - kClear_mm);
  }
  return false;
}

}  // namespace triskin::geometry::surface_lattice

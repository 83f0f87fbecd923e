// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "body_overlap.hpp"
#include "surface_index.hpp"

namespace triskin::check {
namespace {

// Stated and measured numbers may differ because the sides are walked in other steps and normals are interpolated
// differently.
constexpr double kStated_mm = 0.05;
constexpr double kStatedHeight_mm = 0.1;
constexpr double kStep_mm = 0.5;  // Lift and depth are measured in these steps along the sides.

void within_limit(const CheckedDesign& d, Findings& f, const char* rule, std::size_t module, double measured,
                  double limit) {
  if (!(measured <= limit)) f.broken(rule, d.name(module), fmt::format("{:.3f} mm, limit {} mm", measured, limit));
}

void as_stated(const CheckedDesign& d, Findings& f, const char* rule, std::size_t module, double measured,
               double stated) {
  if (!(std::abs(measured - stated) <= kStated_mm))
    f.broken(rule, d.name(module), fmt::format("stated {:.3f} mm, measured {:.3f} mm", stated, measured));
}

// Computes the turn of the normal between the middle and a corner; the radius is the distance divided by that.
void check_bend(const CheckedDesign& d, std::size_t k, const SurfaceIndex& surface, const P3& normal, Findings& f) {
  const CheckedDesign::Module& m = d.modules[k];
  double turn = 0.0;
  for (const P3& corner : m.corner) {
    const P3 there = surface.closest(corner).normal;
    turn = std::max(turn, std::atan2(normal.cross(there).norm(), normal.dot(there)));
  }
  const double stated = m.bend_radius > 0.0 ? (m.corner[0] - centroid(m.corner)).norm() / m.bend_radius : 0.0;
  if (!(std::abs(turn - stated) <= 1e-3)) {
    f.broken("bend-radius", d.name(k),
             fmt::format("states {:.1f} mm, a turn of {:.4f} rad; measured {:.4f} rad", m.bend_radius, stated, turn));
  }
}

void check_overrun(const CheckedDesign& d, std::size_t k, const SurfaceIndex& surface, Findings& f) {
  const auto& m = d.modules[k];
  const Outline3 outline = module_outline(m.corner, d.corner_cut);
  double measured = overrun_of(outline, surface, kPast_mm).mm;
  within_limit(d, f, "overrun", k, measured, d.limits.overrun);
  if (m.overrun > measured + kStated_mm) measured = std::min(m.overrun, overrun_of(outline, surface, -kPast_mm).mm);
  as_stated(d, f, "overrun", k, measured, m.overrun);
}

// Returns the least and the greatest height of the sides over the surface, along its normal.
std::array<double, 2> heights_of_sides(const Outline3& outline, const SurfaceIndex& surface) {
  std::array<double, 2> range{0.0, 0.0};
  for (std::size_t s = 0; s < outline.size(); ++s) {
    const P3 side = outline[(s + 1) % outline.size()] - outline[s];
    const double steps = std::max(1.0, std::round(side.norm() / kStep_mm));
    for (double q = 0.0; q < steps; q += 1.0) {
      const P3 p = outline[s] + side * (q / steps);
      const auto h = surface.closest(p);
      const double height = (p - h.point).dot(h.normal);
      range = {std::min(range[0], height), std::max(range[1], height)};
    }
  }
  return range;
}

void check_sides(const CheckedDesign& d, std::size_t k, const SurfaceIndex& surface, Findings& f) {
  const auto& m = d.modules[k];
  const auto [low, high] = heights_of_sides(module_outline(m.corner, d.corner_cut), surface);
  const auto check = [&](const char* rule, double measured, double stated, double limit) {
    within_limit(d, f, rule, k, measured, limit);
    if (!(std::abs(measured - stated) <= kStatedHeight_mm))
      f.broken(rule, d.name(k), fmt::format("stated {:.3f} mm, measured {:.3f} mm", stated, measured));
  };
  check("edge-depth", -low, m.edge_depth, d.limits.depth);
  if (std::isfinite(d.limits.lift)) check("edge-lift", high, m.edge_lift, d.limits.lift);
}

// Sides are walked in steps, so a wrong side of huge length would take endless time.
bool has_size_of_module(const CheckedDesign::Module& m) {
  for (std::size_t s = 0; s < 3; ++s) {
    const double side = (m.corner[(s + 1) % 3] - m.corner[s]).norm();
    if (!(side > kSide / 4.0 && side < kSide * 4.0)) return false;
  }
  return true;
}

void check_against_surface(const CheckedDesign& d, Findings& f) {
  for (const char* rule : {"center-gap", "overrun", "edge-depth", "outward", "bend-radius"}) f.rule(rule);
  if (std::isfinite(d.limits.lift)) f.rule("edge-lift");
  const SurfaceIndex surface(d);
  for (std::size_t k = 0; k < d.modules.size(); ++k) {
    const auto& m = d.modules[k];
    if (!has_size_of_module(m)) {
      f.broken("overrun", d.name(k), "it has not the size of a module, so it is not measured against the surface");
      continue;
    }
    const P3 c = centroid(m.corner);
    const auto hit = surface.closest(c);
    const double gap = (hit.point - c).norm();
    within_limit(d, f, "center-gap", k, gap, d.limits.center_gap);
    as_stated(d, f, "center-gap", k, gap, m.center_gap);
    const double cosine = hit.normal.dot(unit_normal(m.corner));
    if (!(cosine > 0.5))
      f.broken("outward", d.name(k),
               fmt::format("its normal is {:.0f}° off the surface's", std::acos(cosine) * 180 / M_PI));
    check_bend(d, k, surface, hit.normal, f);
    check_overrun(d, k, surface, f);
    check_sides(d, k, surface, f);
  }
}

bool left_of_all_sides(const Outline3& outline, const P3& normal, const P3& p) {
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const P3& from = outline[k];
    if (!(normal.dot((outline[(k + 1) % outline.size()] - from).cross(p - from)) > 0)) return false;
  }
  return true;
}

// Tests an open segment against the inside of an outline. The heights of the ends over the plane tell whether the
// segment crosses it, and by their ratio where: that point lies on the segment however flat it crosses, so that no
// determinant that vanishes on flat faces decides, and no tolerance is needed.
bool pierces(const P3& a, const P3& b, const Outline3& t) {
  const P3 e1 = t[1] - t[0], e2 = t[2] - t[0], normal = e1.cross(e2);
  const double height_a = normal.dot(a - t[0]), height_b = normal.dot(b - t[0]);
  if (!(height_a < 0 && height_b > 0) && !(height_a > 0 && height_b < 0)) return false;
  const P3 hit = a + height_a / (height_a - height_b) * (b - a), at = hit - t[0];
  if (t.size() > 3) return left_of_all_sides(t, normal, hit);
  // Computes barycentric coordinates by the Gram matrix of the sides; its determinant is the square of twice the area.
  const double g11 = e1.dot(e1), g12 = e1.dot(e2), g22 = e2.dot(e2), r1 = e1.dot(at), r2 = e2.dot(at);
  const double u = g22 * r1 - g12 * r2, v = g11 * r2 - g12 * r1;
  return u > 0 && v > 0 && u + v < g11 * g22 - g12 * g12;
}

// Returns how far inside the other triangle the piercing goes, in space: shrinks one until it no longer pierces.
bool cross_in_space(const Triangle3& a, const Triangle3& b, double cut, double allowed_mm) {
  if ((centroid(a) - centroid(b)).norm() > 2.0 * kSide) return false;
  const Outline3 p = module_outline(a, cut, allowed_mm), q = module_outline(b, cut, allowed_mm);
  if (p.size() < 3 || q.size() < 3) return false;  // A limit above the inner radius allows anything.
  const auto any_side = [](const Outline3& sides, const Outline3& through) {
    for (std::size_t k = 0; k < sides.size(); ++k) {
      if (pierces(sides[k], sides[(k + 1) % sides.size()], through)) return true;
    }
    return false;
  };
  return any_side(p, q) || any_side(q, p);
}

void check_overlap(const CheckedDesign& d, Findings& f) {
  for (const char* rule : {"penetration", "pierced"}) f.rule(rule);
  std::vector<double> worst(d.modules.size(), 0.0);
  for (std::size_t a = 0; a < d.modules.size(); ++a) {
    for (std::size_t b = a + 1; b < d.modules.size(); ++b) {
      const double depth = module_overlap(d.modules[a].corner, d.modules[b].corner, d.corner_cut);
      worst[a] = std::max(worst[a], depth);
      worst[b] = std::max(worst[b], depth);
      if (!(depth <= d.limits.penetration)) {
        f.broken("penetration", d.name(a),
                 fmt::format("overlaps {} by {:.3f} mm, limit {} mm", d.name(b), depth, d.limits.penetration));
      }
      if (cross_in_space(d.modules[a].corner, d.modules[b].corner, d.corner_cut, d.limits.penetration)) {
        f.broken("pierced", d.name(a), "passes through " + d.name(b));
      }
    }
  }
  for (std::size_t k = 0; k < worst.size(); ++k) as_stated(d, f, "penetration", k, worst[k], d.modules[k].penetration);
}

}  // namespace

void check_surface(const CheckedDesign& design, Findings& findings) {
  check_against_surface(design, findings);
  check_overlap(design, findings);
}

}  // namespace triskin::check

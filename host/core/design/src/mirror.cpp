// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/design/mirror.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "triskin/base/error.hpp"

namespace triskin::design {
namespace {

// (i, j) → (j, i) mirrors the plane of the grid at the line at 30°, which lies half-way between its axes.
Vec2 flipped(const Vec2& p) {
  constexpr double kCos60 = 0.5, kSin60 = 0.86602540378443864676;
  return {kCos60 * p.x() + kSin60 * p.y(), kSin60 * p.x() - kCos60 * p.y()};
}

// The first point keeps its place, and the others follow in reverse order.
void turn_ring_over(std::vector<Vec2>& ring) {
  for (Vec2& p : ring) p = flipped(p);
  if (!ring.empty()) std::reverse(ring.begin() + 1, ring.end());
}

}  // namespace

PlacedModule in_mirrored_lattice(PlacedModule m) {
  m.corner_mm = mirrored_corners(m.tile, m.corner_mm);
  m.neighbour = mirrored_sides(m.tile, m.neighbour);
  m.hinge_gap_mm = mirrored_sides(m.tile, m.hinge_gap_mm);
  m.fold_rad = mirrored_sides(m.tile, m.fold_rad);
  m.tile = mirrored_tile(m.tile);
  return m;
}

Vec3 mirrored(const Vec3& p, const MirrorPlane& plane) {
  return p - 2.0 * (plane.normal.dot(p) - plane.offset_mm) * plane.normal;
}

Mesh mirrored(const Mesh& mesh, const MirrorPlane& plane) {
  Mesh image = mesh;
  for (Vec3& v : image.vertices) v = mirrored(v, plane);
  for (auto& f : image.faces) std::swap(f[1], f[2]);
  return image;
}

ModuleLayout mirrored(const ModuleLayout& layout, const MirrorPlane& plane) {
  ModuleLayout image = layout;
  image.jumpers.clear();
  for (PlacedModule& m : image.modules) {
    for (Vec3& c : m.corner_mm) c = mirrored(c, plane);
    m = in_mirrored_lattice(m);
  }
  return image;
}

KindPlan mirrored(KindPlan plan, const MirrorPlane& plane) {
  const bool is_across_axis = plane.normal.cwiseAbs().maxCoeff() > 1.0 - 1e-12;
  std::erase_if(plan.regions,
                [&](const KindRegion& r) { return !is_across_axis && std::holds_alternative<Box>(r.region); });
  for (KindRegion& r : plan.regions) {
    if (auto* sphere = std::get_if<Sphere>(&r.region)) sphere->center_mm = mirrored(sphere->center_mm, plane);
    if (auto* box = std::get_if<Box>(&r.region)) {
      const Vec3 a = mirrored(box->low_mm, plane), b = mirrored(box->high_mm, plane);
      *box = {a.cwiseMin(b), a.cwiseMax(b)};
    }
  }
  return plan;
}

// With F the flip, grid point R(θ)p + t becomes F(R(θ)p + t) = R(−θ)(Fp) + Ft.
Regions mirrored(const Regions& regions, const MirrorPlane& plane) {
  Regions image = regions;
  for (Region& r : image.list) {
    if (auto* sphere = std::get_if<Sphere>(&r.shape)) sphere->center_mm = mirrored(sphere->center_mm, plane);
    if (auto* box = std::get_if<Box>(&r.shape)) {
      if ((plane.normal.array() != 0.0).count() != 1)
        throw InputError(
            fmt::format("region \"{}\" is a box: its mirror image is one at a plane normal to x, y or z alone; name "
                        "its faces instead",
                        r.name));
      const Vec3 a = mirrored(box->low_mm, plane), b = mirrored(box->high_mm, plane);
      *box = {a.cwiseMin(b), a.cwiseMax(b)};
    }
    if (auto* obstacle = std::get_if<Obstacle>(&r.shape)) obstacle->mesh = mirrored(obstacle->mesh, plane);
  }
  return image;
}

PlacedPiece turned_over(PlacedPiece piece) {
  turn_ring_over(piece.piece.outline.outer);
  for (auto& hole : piece.piece.outline.holes) turn_ring_over(hole);
  for (auto& triangle : piece.piece.flat) {
    for (Vec2& p : triangle) p = flipped(p);
    std::swap(triangle[1], triangle[2]);
  }
  const Vec2 at = flipped({piece.placement.x_mm, piece.placement.y_mm});
  piece.placement = {at.x(), at.y(), -piece.placement.theta_rad};
  return piece;
}

}  // namespace triskin::design

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "triskin/design/kinds.hpp"
#include "triskin/design/mesh.hpp"
#include "triskin/design/module.hpp"
#include "triskin/design/piece.hpp"
#include "triskin/design/regions.hpp"

/// A mirror swaps left and right. A module is chiral: its corners run counter-clockwise seen from outside, so that its
/// mirror image is a real module only when its corners are listed in another order. Exchanging the two axes of the
/// lattice, (i, j) → (j, i), does that for all modules of an island alike.
namespace triskin::design {

/// Tile (i, j) → (j, i). Its own inverse, as are the next two.
[[nodiscard]] constexpr Tile mirrored_tile(const Tile& t) {
  return {t.j, t.i, t.up};
}
/// Values of corners (0 … 2) of a tile → of the same corners in the mirrored tile: an up triangle keeps corner 0, a
/// down one corner 1.
template <class T>
[[nodiscard]] constexpr std::array<T, 3> mirrored_corners(const Tile& t, const std::array<T, 3>& c) {
  return t.up ? std::array<T, 3>{c[0], c[2], c[1]} : std::array<T, 3>{c[2], c[1], c[0]};
}
/// The same of sides; side s lies between corners s and s + 1.
template <class T>
[[nodiscard]] constexpr std::array<T, 3> mirrored_sides(const Tile& t, const std::array<T, 3>& s) {
  return t.up ? std::array<T, 3>{s[2], s[1], s[0]} : std::array<T, 3>{s[1], s[0], s[2]};
}

/// A module whose corners stand where they should, as the mirrored lattice numbers them: corners, sides and tile; its
/// metrics of joints move with the sides.
[[nodiscard]] PlacedModule in_mirrored_lattice(PlacedModule module);

/// The points p with normal · p = offset_mm; `normal` has unit length.
struct MirrorPlane {
  Vec3 normal = Vec3::UnitX();
  double offset_mm = 0.0;
};
/// Mirror image of a point, mm. Constant cost.
[[nodiscard]] Vec3 mirrored(const Vec3& point_mm, const MirrorPlane& plane);
/// Mirror image of a mesh: each face is listed the other way round, its first corner first, so that normals point
/// outwards still. Cost: linear.
[[nodiscard]] Mesh mirrored(const Mesh& mesh, const MirrorPlane& plane);
/// Mirror image of a layout: real modules of the mirrored lattice. Metrics stay as they are; jumpers are left out,
/// since wiring makes them. Cost: linear.
[[nodiscard]] ModuleLayout mirrored(const ModuleLayout& layout, const MirrorPlane& plane);
/// Mirror image of regions. Errors: InputError for a box at a plane that is not normal to an axis: the image would be
/// no box. Cost: linear.
[[nodiscard]] Regions mirrored(const Regions& regions, const MirrorPlane& plane);
/// A flat piece turned over, for the mirrored mesh: outlines run counter-clockwise still, and the mirrored tiles lie in
/// it as the tiles did. Cost: linear.
[[nodiscard]] PlacedPiece turned_over(PlacedPiece piece);

/// Kinds for the mirrored layout: spheres and, at a plane across an axis, boxes are mirrored, lists stay. A box at
/// another plane would be no box and is left out; modules keep their kinds all the same. Cost: linear.
[[nodiscard]] KindPlan mirrored(KindPlan plan, const MirrorPlane& plane);

}  // namespace triskin::design

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>

#include "triskin/design/kinds.hpp"
#include "triskin/design/mesh.hpp"
#include "triskin/design/module.hpp"
#include "triskin/design/piece.hpp"
#include "triskin/design/regions.hpp"

/// Mirroring swaps left and right. A module is chiral: its corners run counter-clockwise seen from outside, so its
/// mirror image is a real module only if the corners are listed in another order. Exchanging the two axes of the
/// lattice, (i, j) → (j, i), does this in the same way for all modules of an island.
namespace triskin::design {

/// Maps tile (i, j) to (j, i). The function is its own inverse, as are the next two.
[[nodiscard]] constexpr Tile mirrored_tile(const Tile& t) {
  return {t.j, t.i, t.up};
}
/// Moves values of corners (0 … 2) of a tile to the same corners in the mirrored tile: an up triangle keeps corner 0,
/// a down one corner 1.
template <class T>
[[nodiscard]] constexpr std::array<T, 3> mirrored_corners(const Tile& t, const std::array<T, 3>& c) {
  return t.up ? std::array<T, 3>{c[0], c[2], c[1]} : std::array<T, 3>{c[2], c[1], c[0]};
}
/// Moves values of sides in the same way; side s lies between corners s and s + 1.
template <class T>
[[nodiscard]] constexpr std::array<T, 3> mirrored_sides(const Tile& t, const std::array<T, 3>& s) {
  return t.up ? std::array<T, 3>{s[2], s[1], s[0]} : std::array<T, 3>{s[1], s[0], s[2]};
}

/// Renumbers a module whose corners are already in their mirrored places: corners, sides and tile become those of the
/// mirrored lattice, and the metrics of joints move with the sides.
[[nodiscard]] PlacedModule in_mirrored_lattice(PlacedModule module);

/// The plane consists of the points p with normal · p = offset_mm; `normal` has unit length.
struct MirrorPlane {
  Vec3 normal = Vec3::UnitX();
  double offset_mm = 0.0;
};
/// Mirrors a point, in mm. Constant cost.
[[nodiscard]] Vec3 mirrored(const Vec3& point_mm, const MirrorPlane& plane);
/// Mirrors a mesh. The vertices of each face are listed in reverse after the first one, so that normals still point
/// outwards. Cost: linear.
[[nodiscard]] Mesh mirrored(const Mesh& mesh, const MirrorPlane& plane);
/// Mirrors a layout, which gives real modules of the mirrored lattice. Metrics do not change; jumpers are left out,
/// because wiring makes them. Cost: linear.
[[nodiscard]] ModuleLayout mirrored(const ModuleLayout& layout, const MirrorPlane& plane);
/// Mirrors regions. Errors: InputError for a box at a plane that is not normal to an axis, because the image would not
/// be a box. Cost: linear.
[[nodiscard]] Regions mirrored(const Regions& regions, const MirrorPlane& plane);
/// Turns a flat piece over for the mirrored mesh: outlines still run counter-clockwise, and each mirrored tile lies
/// where the tile was in the piece. Cost: linear.
[[nodiscard]] PlacedPiece turned_over(PlacedPiece piece);

/// Mirrors kinds: spheres, and boxes at a plane normal to an axis, are mirrored; lists do not change. At any other
/// plane a box would not stay a box and is left out, but the modules keep their kinds. Cost: linear.
[[nodiscard]] KindPlan mirrored(KindPlan plan, const MirrorPlane& plane);

}  // namespace triskin::design

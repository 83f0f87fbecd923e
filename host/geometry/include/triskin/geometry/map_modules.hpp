// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/geometry/design_types.hpp"
#include "triskin/geometry/placement.hpp"
#include "triskin/geometry/surface.hpp"
#include "triskin/geometry/unfolding.hpp"

namespace triskin::geometry {

/// A piece with its tiles on the plane.
struct TiledPiece {
  const Piece* piece = nullptr;
  Placement placement;
  std::vector<Tile> tiles;
};

/// Brings placed tiles back to the surface as rigid modules: corners through the flat triangles, then joined corners
/// are averaged, projected and refitted (Kabsch) until they settle; modules and joints that break a limit are given up,
/// the worst first. Islands are what stays joined. Metrics of each module are measured against the surface
/// (docs/design_file.md says how each is defined).
[[nodiscard]] ModuleLayout map_modules(const Surface& surface, const std::vector<TiledPiece>& pieces,
                                       const LayoutLimits& limits);

/// Measures the layout and gives up what breaks a limit, the worst first: joints become slits, modules go (counted in
/// layout.refused). Numbers the islands anew by what stays joined.
void keep_limits(const Surface& surface, const LayoutLimits& limits, ModuleLayout& layout);

/// Measures every metric of every module of the layout: both of the following.
void measure(const Surface& surface, ModuleLayout& layout);

/// What depends on the surface alone: gap under the centre, depth, overrun, bend radius. Sides are walked every 0.5 mm
/// for the depth, by bisection where they leave the surface; its area is searched for border under it. Cost: ~200
/// closest-point queries.
void measure_on_surface(const Surface& surface, PlacedModule& module);

/// What depends on the other modules: joints and penetration. Cost: n² / 2 distances.
void measure_between(ModuleLayout& layout);

/// Depth of overlap of two modules in the plane of their mean normal, 0 when apart or not lying over each other, mm.
[[nodiscard]] double penetration_depth(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b);

}  // namespace triskin::geometry

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

#include "triskin/design/design_types.hpp"
#include "triskin/mesh/surface.hpp"
#include "triskin/mesh/surface_regions.hpp"

namespace triskin::lattice {

/// Input of map_modules(): a piece, its place on the grid, and the tiles inside it.
struct TiledPiece {
  const Piece* piece = nullptr;  ///< The piece is not owned and must outlive the call.
  Placement placement;
  std::vector<Tile> tiles;
};

/// Maps placed tiles back to the surface as rigid modules: corners through the flat triangles, then joined corners are
/// averaged, projected and refitted (Kabsch) until they settle; modules and joints that break a limit are dropped, the
/// worst first. Connected modules form an island. The metrics of each module are those of measure(). `corner_cut_mm`
/// (design/outline.hpp) is that of the tiles; corners that are cut off may overhang the border. With `regions` of the
/// surface, modules that reach into one that must stay free are dropped. `give_up` is asked between pieces, after some
/// thousand modules: when true, the remaining pieces are left out, their modules counted in layout.refused as
/// "time_limit". Errors: none for pieces of this surface. Deterministic; thread-safe. Cost: that of measure() per round
/// of refitting. Source: W. Kabsch, Acta Cryst. A32 (1976).
[[nodiscard]] ModuleLayout map_modules(const mesh::Surface& surface, const std::vector<TiledPiece>& pieces,
                                       const LayoutLimits& limits, double corner_cut_mm = 0.0,
                                       const mesh::SurfaceRegions* regions = nullptr,
                                       const std::function<bool()>& give_up = {});

/// Measures the layout and drops what breaks a limit, the worst first: joints become slits, modules are removed
/// (counted in layout.refused, names as in design files). Renumbers the islands by the remaining joints. Cost:
/// measure() once, then only changes.
void keep_limits(const mesh::Surface& surface, const LayoutLimits& limits, ModuleLayout& layout,
                 const mesh::SurfaceRegions* regions = nullptr);

/// Removes the modules for which `gone` is true; the others keep their order, and their sides towards removed ones
/// become free. Returns the new id by old id, −1 for removed ones. Islands and jumpers keep their numbers. Cost:
/// O(n).
std::vector<int> remove_modules(ModuleLayout& layout, const std::vector<bool>& gone);

/// Renumbers the islands 0, 1, … by joints, in the order of their first modules. Cost: O(n).
void number_islands(ModuleLayout& layout);

/// Computes every metric of every module of the layout: measure_on_surface() of each, then measure_between().
/// docs/design_file.md defines the metrics; all ≥ 0.
void measure(const mesh::Surface& surface, ModuleLayout& layout, const mesh::SurfaceRegions* regions = nullptr);

/// Measures what depends on the surface alone: gap under the centre, lift, depth, overrun (mm, at most 0.02 mm too
/// small), bend radius. All but gap and radius refer to the outline after the corner cut. Sides are walked every 0.5 mm
/// for lift and depth, by bisection where they leave the surface; the area is searched for border under it. Cost: ~200
/// closest-point queries.
void measure_on_surface(const mesh::Surface& surface, PlacedModule& module, double corner_cut_mm = 0.0,
                        const mesh::SurfaceRegions* regions = nullptr);

/// Measures what depends on the other modules: edge error, hinge gap and fold of each joint, penetration. Cost: some
/// µs per module.
void measure_between(ModuleLayout& layout);

/// Returns the depth in mm by which two modules (corners in mm, counter-clockwise; less their corner cut) overlap: up
/// to 101.5° between their normals in the plane of the mean normal, beyond as bodies 2 mm high (docs/limits.md); 0 if
/// they are apart or do not lie over each other. Separating axes; constant cost.
[[nodiscard]] double penetration_depth(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b,
                                       double corner_cut_mm = 0.0);

}  // namespace triskin::lattice

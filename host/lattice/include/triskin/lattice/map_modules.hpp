// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

#include "triskin/design/design_types.hpp"
#include "triskin/mesh/surface.hpp"
#include "triskin/mesh/surface_regions.hpp"

namespace triskin::geometry {

/// Input of map_modules(): a piece, where it lies on the grid, and the tiles inside it.
struct TiledPiece {
  const Piece* piece = nullptr;  ///< It is not owned and must outlive the call.
  Placement placement;
  std::vector<Tile> tiles;
};

/// Brings placed tiles back to the surface as rigid modules: corners through the flat triangles, then joined corners
/// are averaged, projected and refitted (Kabsch) until they settle; modules and joints that break a limit are given up,
/// the worst first. Islands are what stays joined. The metrics of each module are those of measure(). `corner_cut_mm`
/// (design/outline.hpp): that of the tiles; corners that are cut off may stand over the border.
/// `regions` of the surface: what reaches into one that must stay free is given up.
/// `give_up` is asked between pieces, after some thousand modules: when true, the pieces that follow are left out,
/// their modules counted in layout.refused as "time_limit". Errors: none for pieces of this surface. Deterministic;
/// thread-safe. Cost: that of measure() a round of refitting. Source: W. Kabsch, Acta Cryst. A32 (1976).
[[nodiscard]] ModuleLayout map_modules(const Surface& surface, const std::vector<TiledPiece>& pieces,
                                       const LayoutLimits& limits, double corner_cut_mm = 0.0,
                                       const SurfaceRegions* regions = nullptr,
                                       const std::function<bool()>& give_up = {});

/// Measures the layout and gives up what breaks a limit, the worst first: joints become slits, modules go (counted in
/// layout.refused, names as in design files). Numbers the islands anew by what stays joined. Cost: measure() once, then
/// what changes.
void keep_limits(const Surface& surface, const LayoutLimits& limits, ModuleLayout& layout,
                 const SurfaceRegions* regions = nullptr);

/// Takes out the modules for which `gone` is true; those that stay keep their order, and sides towards what went are
/// free. Returns the new id by old id, −1: gone. Islands and jumpers stay as they are numbered. Cost: O(n).
std::vector<int> remove_modules(ModuleLayout& layout, const std::vector<bool>& gone);

/// Numbers the islands anew, 0, 1, …, by what is joined: as their first modules come. Cost: O(n).
void number_islands(ModuleLayout& layout);

/// Measures every metric of every module of the layout: measure_on_surface() of each, then measure_between(). Metrics
/// are defined in docs/design_file.md; all ≥ 0.
void measure(const Surface& surface, ModuleLayout& layout, const SurfaceRegions* regions = nullptr);

/// Measures what depends on the surface alone: gap under the centre, lift, depth, overrun (mm, to 0.02 mm below),
/// bend radius. All but gap and radius are those of the outline that the cut leaves. Sides are walked every 0.5 mm for
/// lift and depth, by bisection where they leave the surface; its area is searched for border under it. Cost: ~200
/// closest-point queries.
void measure_on_surface(const Surface& surface, PlacedModule& module, double corner_cut_mm = 0.0,
                        const SurfaceRegions* regions = nullptr);

/// Measures what depends on the other modules: edge error, hinge gap and fold of each joint, penetration. Cost: some
/// µs a module.
void measure_between(ModuleLayout& layout);

/// Depth of overlap of two modules (corners in mm, counter-clockwise; less their corner cut) in the plane of their mean
/// normal, mm; 0 when they are apart or do not lie over each other. Separating axes; constant cost.
[[nodiscard]] double penetration_depth(const std::array<Vec3, 3>& a, const std::array<Vec3, 3>& b,
                                       double corner_cut_mm = 0.0);

}  // namespace triskin::geometry

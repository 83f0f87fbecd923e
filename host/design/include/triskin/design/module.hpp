// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string>
#include <vector>

#include "triskin/base/names.hpp"
#include "triskin/design/jumper.hpp"
#include "triskin/design/mesh.hpp"
#include "triskin/design/tile.hpp"

namespace triskin::design {

/// Limits that a semi-rigid module and its hinges tolerate; each > 0 but the last. docs/design_file.md defines every
/// metric. Defaults: the installed iCub skin (30 mm modules on 32 mm pitch).
struct LayoutLimits {
  double edge_error_mm = 1.0;            ///< largest |length on the net − length of the rigid module| of an edge
  double hinge_gap_mm = 2.0;             ///< largest distance between joined corners of two neighbours
  double center_gap_mm = 3.0;            ///< largest distance from a module's centroid to the surface
  double fold_rad = 1.0471975511965976;  ///< largest angle between the planes of joined modules (60°)
  double penetration_mm = 0.5;           ///< largest depth by which two modules may overlap
  double overrun_mm = 0.5;  ///< largest distance by which a module may stand over the border of the surface
  double lift_mm = 3.5;     ///< largest height of corners and sides above the surface; infinity: no limit (old files)
  double depth_mm = 4.5;    ///< largest depth of corners and sides under the surface; infinity: no limit (old files)
  double jumper_mm = 15.0;  ///< longest jumper along the surface; 0: no jumpers. In the file only beside jumpers
};

/// One rigid module on the surface. Its id is its index in ModuleLayout::modules. Corners are those of its tile, in
/// tile order (tile.hpp), so that side s runs from corner s to corner (s+1) % 3 counter-clockwise seen from outside.
struct PlacedModule {
  int island = 0;                            ///< 0-based
  Tile tile;                                 ///< unique within the island
  std::array<Vec3, 3> corner_mm;             ///< exactly rigid: sides of 30 mm
  std::array<int, 3> neighbour{-1, -1, -1};  ///< id of the module joined across side s, or -1; symmetric
  /// Metrics against the mesh; all ≥ 0 (see LayoutLimits). Sides without a neighbour hold 0.
  double edge_error_mm = 0.0;
  std::array<double, 3> hinge_gap_mm{};
  std::array<double, 3> fold_rad{};
  double center_gap_mm = 0.0;
  double edge_lift_mm = 0.0;   ///< largest height of a point of the sides, corners too, above the surface
  double edge_depth_mm = 0.0;  ///< the same under the surface
  double penetration_mm = 0.0;
  double overrun_mm = 0.0;
  double keep_out_mm = 0.0;     ///< how far it reaches into a region that must stay free; limit: overrun_mm
  double bend_radius_mm = 0.0;  ///< smallest radius of curvature under the module; 0 when flat
  int kind = 0;                 ///< number of the kind (kinds.hpp), 0: the standard one
};

/// Method that made a layout.
enum class LayoutMethod {
  kPieces,   ///< the surface unfolded, each piece placed with a certified optimum
  kSurface,  ///< lattice grown on the surface
};
/// Names in the design file: "pieces", "surface".
inline constexpr NameTable kLayoutMethodNames{std::array<std::pair<LayoutMethod, std::string_view>, 2>{
    {{LayoutMethod::kPieces, "pieces"}, {LayoutMethod::kSurface, "surface"}}}};

/// Modules of a part. An island is a set of modules joined through `neighbour`; islands have numbers 0 … islands - 1
/// and need not share a lattice.
struct ModuleLayout {
  std::vector<PlacedModule> modules;
  int islands = 0;
  LayoutMethod method = LayoutMethod::kPieces;
  /// Modules that were refused, per limit that refused them (name → count), for the report.
  std::vector<std::pair<std::string, int>> refused;
  /// Cut at every corner of every module (outline.hpp); corner_mm still describe the whole triangle.
  double corner_cut_mm = 0.0;
  /// Joints between islands. PlacedModule::neighbour does not show them; graph_of() and joints_of() do.
  std::vector<Jumper> jumpers;
};

}  // namespace triskin::design

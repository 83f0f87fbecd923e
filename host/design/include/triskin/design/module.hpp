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
  double hinge_gap_mm = 2.0;             ///< Joined corners of two neighbours are at most so far apart.
  double center_gap_mm = 3.0;            ///< The centroid of a module is at most so far from the surface.
  double fold_rad = 1.0471975511965976;  ///< The planes of joined modules differ by at most this angle, 60°.
  double penetration_mm = 0.5;           ///< Two modules may overlap by at most this depth.
  double overrun_mm = 0.5;  ///< A module may stand over the border of the surface by at most this distance.
  /// Corners and sides are at most so high above the surface; infinity, as in old files, means no limit.
  double lift_mm = 3.5;
  /// Corners and sides are at most so deep under the surface; infinity, as in old files, means no limit.
  double depth_mm = 4.5;
  /// A jumper is at most so long along the surface; 0 allows none. It is in the file only beside jumpers.
  double jumper_mm = 15.0;
};

/// One rigid module on the surface. Its id is its index in ModuleLayout::modules. Corners are those of its tile, in
/// tile order (tile.hpp), so that side s runs from corner s to corner (s+1) % 3 counter-clockwise seen from outside.
struct PlacedModule {
  int island = 0;                 ///< It is counted from 0.
  Tile tile;                      ///< It is unique within the island.
  std::array<Vec3, 3> corner_mm;  ///< They are exactly rigid, with sides of 30 mm.
  /// It is the id of the module joined across side s, or −1, and is symmetric.
  std::array<int, 3> neighbour{-1, -1, -1};
  /// Metrics against the mesh; all ≥ 0 (see LayoutLimits). Sides without a neighbour hold 0.
  double edge_error_mm = 0.0;
  std::array<double, 3> hinge_gap_mm{};
  std::array<double, 3> fold_rad{};
  double center_gap_mm = 0.0;
  double edge_lift_mm = 0.0;   ///< No point of the sides, corners included, is higher above the surface.
  double edge_depth_mm = 0.0;  ///< No point of the sides, corners included, is deeper under the surface.
  double penetration_mm = 0.0;
  double overrun_mm = 0.0;
  /// The module reaches so far into a region that must stay free; the limit is overrun_mm.
  double keep_out_mm = 0.0;
  double bend_radius_mm = 0.0;  ///< It is the smallest radius of curvature under the module, and 0 when flat.
  int kind = 0;                 ///< It is the number of the kind (kinds.hpp); 0 is the standard one.
};

/// Method that made a layout.
enum class LayoutMethod {
  kPieces,   ///< The surface is unfolded, and each piece is placed with a certified optimum.
  kSurface,  ///< The lattice is grown on the surface.
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

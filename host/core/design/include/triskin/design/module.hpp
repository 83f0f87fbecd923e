// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <vector>

#include "triskin/base/names.hpp"
#include "triskin/design/jumper.hpp"
#include "triskin/design/mesh.hpp"
#include "triskin/design/tile.hpp"

namespace triskin::design {

/// A semi-rigid module and its hinges tolerate these limits; each is > 0 except the last. docs/design_file.md defines
/// every metric. The defaults are those of the installed iCub skin (30 mm modules on 32 mm pitch).
struct LayoutLimits {
  double edge_error_mm = 1.0;  ///< An edge on the net may differ by this much from the length of the rigid module.
  double hinge_gap_mm = 2.0;   ///< Joined corners of two neighbours are at most this far apart.
  double center_gap_mm = 3.0;  ///< The centroid of a module is at most this far from the surface.
  double fold_rad = 1.0471975511965976;  ///< The planes of joined modules differ by at most this angle, 60°.
  double penetration_mm = 0.5;           ///< Two modules may overlap by at most this depth.
  double overrun_mm = 0.5;  ///< A module may extend beyond the border of the surface by at most this distance.
  /// Corners and sides are at most this high above the surface; infinity, as in old files, means no limit.
  double lift_mm = 3.5;
  /// Corners and sides are at most this deep below the surface; infinity, as in old files, means no limit.
  double depth_mm = 4.5;
  /// A jumper is at most this long along the surface; 0 allows none. The file has this limit only beside jumpers.
  double jumper_mm = 15.0;
  /// A joint that folds away from the touch side, as over a ridge, has at most this angle and at most fold_rad.
  double fold_away_rad = std::numeric_limits<double>::infinity();
  /// A joint that folds towards the touch side, as in a valley, has at most this angle and at most fold_rad.
  double fold_towards_rad = std::numeric_limits<double>::infinity();
};

/// Returns the largest angle of a joint that folds away from the touch side, or towards it.
[[nodiscard]] inline double fold_limit_rad(const LayoutLimits& limits, bool is_away) {
  return std::min(limits.fold_rad, is_away ? limits.fold_away_rad : limits.fold_towards_rad);
}

/// Modules on the surface are rigid. The id of a module is its index in ModuleLayout::modules; what people read is its
/// number (module_number.hpp). Its corners are in the
/// order of its tile (tile.hpp), so that side s runs from corner s to corner (s+1) % 3, counter-clockwise seen from
/// outside.
struct PlacedModule {
  int island = 0;                 ///< Islands are numbered from 0.
  Tile tile;                      ///< No other module of the island has the same tile.
  std::array<Vec3, 3> corner_mm;  ///< The corners form an exactly rigid triangle with sides of 30 mm.
  /// Entry s is the id of the module joined across side s, or −1; the relation is symmetric.
  std::array<int, 3> neighbour{-1, -1, -1};
  /// The following metrics compare the module with the mesh; all are ≥ 0 (see LayoutLimits). Sides without a
  /// neighbour have 0.
  double edge_error_mm = 0.0;
  std::array<double, 3> hinge_gap_mm{};
  std::array<double, 3> fold_rad{};
  double center_gap_mm = 0.0;
  double edge_lift_mm = 0.0;   ///< No point of the sides, including corners, is higher above the surface.
  double edge_depth_mm = 0.0;  ///< No point of the sides, including corners, is deeper below the surface.
  double penetration_mm = 0.0;
  double overrun_mm = 0.0;
  /// The module extends this far into a region that must stay free; the limit is overrun_mm.
  double keep_out_mm = 0.0;
  double bend_radius_mm = 0.0;  ///< The smallest radius of curvature under the module counts; 0 means flat.
  int kind = 0;                 ///< Kind 0 is the standard one (kinds.hpp).
};

enum class LayoutMethod {
  kPieces,   ///< The surface is unfolded, and each piece is placed with a certified optimum.
  kSurface,  ///< The lattice is grown on the surface.
};
/// The design file uses these names: "pieces", "surface".
inline constexpr NameTable kLayoutMethodNames{std::array<std::pair<LayoutMethod, std::string_view>, 2>{
    {{LayoutMethod::kPieces, "pieces"}, {LayoutMethod::kSurface, "surface"}}}};

/// A layout consists of the modules of a part. An island is a set of modules joined through `neighbour`; islands are
/// numbered 0 … islands - 1 and may lie on different lattices.
struct ModuleLayout {
  std::vector<PlacedModule> modules;
  int islands = 0;
  LayoutMethod method = LayoutMethod::kPieces;
  /// For the report, each limit (name) has the count of modules that it refused.
  std::vector<std::pair<std::string, int>> refused;
  /// Every module is cut at every corner by this length (outline.hpp); corner_mm still describes the whole triangle.
  double corner_cut_mm = 0.0;
  /// Jumpers join islands. PlacedModule::neighbour does not show them; graph_of() and joints_of() do.
  std::vector<Jumper> jumpers;
  /// The numbers of the modules (module_number.hpp), ascending; empty: 0, 1, 2 … without gaps.
  std::vector<int> numbers;
};

}  // namespace triskin::design

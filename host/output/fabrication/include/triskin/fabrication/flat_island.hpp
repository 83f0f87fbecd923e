// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/sheet/sides.hpp"

namespace triskin::fabrication {

/// Every corner of a module on a fabricated sheet is cut by this much unless the design cuts more. Six folds that meet
/// in one point would tear there, and modules that touch only in a point would not form a board.
inline constexpr double kCornerRelief_mm = 1.0;
inline constexpr double kMaxCornerRelief_mm = 3.4;  ///< The limit equals design::kHarmlessCornerCut_mm.

/// A line of a flat island along which it is folded, between the ends of the corner cuts; seen from the touch side.
struct Fold {
  design::Vec2 from_mm, to_mm;
  /// Seen from the touch side, a positive angle folds away from the viewer, a negative one towards the viewer.
  double angle_rad = 0.0;
  std::array<int, 2> module{-1, -1};  ///< The lower id comes first.
  bool carries_lines = false;         ///< False means that the traces are cut here.
};

/// A line along which a flat island is cut through although modules lie on both sides of it.
struct Slit {
  design::Vec2 from_mm, to_mm;
  std::array<int, 2> module{-1, -1};
};

/// A text on a flat island. It runs along `angle_rad` (counter-clockwise) with its middle at `at_mm`.
struct Mark {
  design::Vec2 at_mm;
  std::string text;
  double height_mm = 2.0;
  double angle_rad = 0.0;
};

/// An island laid flat like its lattice, seen from the touch side: x to the right, y up, mm, its box begins at (0, 0).
/// Modules keep their side of 30 mm there, because the bending of the surface is in the folds.
struct FlatIsland {
  int island = 0;
  std::string part_number;      ///< The number reads NAME-I<island>-<first 8 digits of the design's id>.
  std::vector<int> modules;     ///< The ids are ascending.
  design::Vec2 shift_mm{0, 0};  ///< Grid vertex (0, 0) has this position.
  double corner_cut_mm = 0.0;   ///< This length is cut off along each side from every corner.
  /// The outline is closed and counter-clockwise; the last point does not repeat the first.
  std::vector<design::Vec2> outline_mm;
  std::vector<std::vector<design::Vec2>> holes_mm;  ///< Holes are stored in the same way, but clockwise.
  std::vector<Fold> folds;
  std::vector<Slit> slits;
  std::vector<Mark> marks;  ///< Marks show the number of each module, its port A, cables and the part number.
};

/// Returns the position of corner `corner` (0 … 2) of a tile on a flat island, mm. Constant cost.
[[nodiscard]] design::Vec2 corner_on(const FlatIsland& island, const design::Tile& tile, int corner);

/// Returns the direction of a fold's text, counter-clockwise, −90° … 90°, so that it is upright. Constant cost.
[[nodiscard]] double text_angle_rad(const Fold& fold);

/// Lays the islands of a design flat. `sides` must be sides_of() of the same design; `relief_mm` must be above 0 and at
/// most kMaxCornerRelief_mm. Errors: InputError for a relief out of range and for a design without modules. Cost: O(n
/// log n).
[[nodiscard]] std::vector<FlatIsland> flat_islands(const design::Design& design, const sheet::Sides& sides,
                                                   double relief_mm = kCornerRelief_mm);

/// Writes a flat island as a drawing for a laser or a board house (DXF R12, mm, y up): layers OUTLINE, HOLES, FOLDS,
/// SLITS and MARKS. Cost: linear.
[[nodiscard]] std::string island_dxf(const FlatIsland& island);

/// Makes a text that is safe in file names, part numbers and quoted KiCad strings: letters, digits, dot, hyphen and
/// underscore of `text`, everything else as underscore.
[[nodiscard]] std::string plain_name(const std::string& text);

}  // namespace triskin::fabrication

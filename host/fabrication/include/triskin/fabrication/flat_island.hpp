// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <string>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/sheet/sides.hpp"

namespace triskin::fabrication {

/// Cut at every corner of a module on a fabricated sheet unless the design cuts more, mm. Six folds that meet in one
/// point would tear there, and modules that touch in a point only would be no board.
inline constexpr double kCornerRelief_mm = 1.0;
inline constexpr double kMaxCornerRelief_mm = 3.4;  ///< design::kHarmlessCornerCut_mm

/// A line of a flat island along which it is folded, between the ends of the corner cuts; seen from the touch side.
struct Fold {
  design::Vec2 from_mm, to_mm;
  double angle_rad = 0.0;             ///< above 0: away from who looks at the touch side, below 0: towards
  std::array<int, 2> module{-1, -1};  ///< the lesser first
  bool carries_lines = false;         ///< false: the traces are cut here
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

/// An island as its lattice is, flat, seen from the touch side: x to the right, y up, mm, its box begins at (0, 0).
/// Modules keep their side of 30 mm there: what the surface does to an island is in its folds.
struct FlatIsland {
  int island = 0;
  std::string part_number;                          ///< NAME-I<island>-<first 8 digits of the design's id>
  std::vector<int> modules;                         ///< ids, ascending
  design::Vec2 shift_mm{0, 0};                      ///< position of grid vertex (0, 0)
  double corner_cut_mm = 0.0;                       ///< cut along each side from every corner
  std::vector<design::Vec2> outline_mm;             ///< closed, counter-clockwise, last point not repeated
  std::vector<std::vector<design::Vec2>> holes_mm;  ///< the same, clockwise
  std::vector<Fold> folds;
  std::vector<Slit> slits;
  std::vector<Mark> marks;  ///< number of each module, its port A, cables, the part number
};

/// Position of corner `corner` (0 … 2) of a tile on a flat island, mm. Constant cost.
[[nodiscard]] design::Vec2 corner_on(const FlatIsland& island, const design::Tile& tile, int corner);

/// Direction of a fold's text, counter-clockwise, −90° … 90°: it stands upright. Constant cost.
[[nodiscard]] double text_angle_rad(const Fold& fold);

/// The islands of a design, flat. `sides`: sides_of() of the same design. `relief_mm`: above 0, at most
/// kMaxCornerRelief_mm. Errors: InputError for a relief out of range and for a design without modules. Cost: O(n log
/// n).
[[nodiscard]] std::vector<FlatIsland> flat_islands(const design::Design& design, const sheet::Sides& sides,
                                                   double relief_mm = kCornerRelief_mm);

/// A flat island as a drawing for a laser or a board house (DXF R12, mm, y up): layers OUTLINE, HOLES, FOLDS, SLITS and
/// MARKS. Cost: linear.
[[nodiscard]] std::string island_dxf(const FlatIsland& island);

/// A text that may stand in file names, part numbers and quoted KiCad strings: letters, digits, dot, hyphen and
/// underscore of `text`, all else as underscore.
[[nodiscard]] std::string plain_name(const std::string& text);

}  // namespace triskin::fabrication

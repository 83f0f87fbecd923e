// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/base/names.hpp"
#include "triskin/design/design.hpp"
#include "triskin/sheet/landmarks.hpp"
#include "triskin/sheet/sides.hpp"

namespace triskin::sheet {

/// What the sheet is printed on.
enum class Paper {
  kA4,
  kA3,
  kRoll,  ///< 610 mm wide, each island as long as it needs; text pages are A4
};
/// Names on the command line: "A4", "A3", "roll".
inline constexpr NameTable kPaperNames{std::array<std::pair<Paper, std::string_view>, 3>{
    {{Paper::kA4, "A4"}, {Paper::kA3, "A3"}, {Paper::kRoll, "roll"}}}};

// Lengths on a page, mm. A page is measured from its upper left corner, y downwards.
inline constexpr double kMargin_mm = 8.0;
inline constexpr double kHead_mm = 30.0;    ///< title and QR code
inline constexpr double kFoot_mm = 14.0;    ///< ruler
inline constexpr double kLabels_mm = 12.0;  ///< around an island, for what is written outside of it

/// A page that shows modules of one island at 1:1, seen from outside (the touch side).
struct IslandPage {
  int island = 0;
  int part = 0, parts = 1;  ///< an island that is larger than the paper has several pages; every module is on one
  int sixths = 0;           ///< turned counter-clockwise by this many times 60°: an up tile lies up where it is even
  design::Vec2 shift_mm{0, 0};  ///< position of grid vertex (0, 0) on the page
  std::vector<int> modules{};   ///< module ids, ascending
  /// Grid vertex (i, j) on the page, mm.
  [[nodiscard]] design::Vec2 at(const std::array<int, 2>& vertex) const;
  /// The corners of a tile on the page, mm; counter-clockwise as one sees it.
  [[nodiscard]] std::array<design::Vec2, 3> corners_of(const design::Tile& tile) const;
};

/// What a line of a text page is.
enum class LineKind { kTitle, kText, kTick, kHead, kRow, kTickRow, kGap };
/// One line of a text page. Cells stand at `columns_mm` from the left margin; without columns there is one cell.
struct TextLine {
  LineKind kind = LineKind::kText;
  std::vector<std::string> cells;
  std::vector<double> columns_mm;
};

/// What a page shows.
enum class PageKind { kOverview, kKey, kText, kIsland };
/// One page of the sheet.
struct Page {
  PageKind kind = PageKind::kText;
  std::string title{};
  int patch = -1;  ///< patch of the page's QR code, −1: it has none
  design::Vec2 size_mm{210, 297};
  std::vector<TextLine> lines{};  ///< content of a text page
  IslandPage island{};            ///< content of an island page
};

/// A point of an island that is measured on the part: a corner of a module, or where corners are cut the end of side
/// `corner` at it.
struct Anchor {
  int module = -1, corner = 0;
  Fix fix;
};

/// All that the pages show, before anything is drawn.
struct Plan {
  Sides sides;
  std::vector<design::ModuleWiring> wiring;  ///< indexed by module
  std::vector<Landmark> landmarks;
  std::vector<std::array<Anchor, 2>> anchors;  ///< indexed by island; module −1 if the island has no module
  std::vector<int> page_of_module;             ///< 1-based page that shows it at 1:1
  std::vector<Page> pages;
};
/// Plans the sheet: overview, key, parts, order of work, one table a controller, islands. Errors: InputError for a
/// design without modules. Cost: O(n log n) beside sides_of().
[[nodiscard]] Plan plan_of(const design::Design& design, Paper paper);

}  // namespace triskin::sheet

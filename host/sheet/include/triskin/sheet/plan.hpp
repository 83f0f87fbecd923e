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
  kRoll,  ///< The roll is 610 mm wide, each island takes the length it needs, and text pages are A4.
};
/// Names on the command line: "A4", "A3", "roll".
inline constexpr NameTable kPaperNames{std::array<std::pair<Paper, std::string_view>, 3>{
    {{Paper::kA4, "A4"}, {Paper::kA3, "A3"}, {Paper::kRoll, "roll"}}}};

// Lengths on a page, mm. A page is measured from its upper left corner, y downwards.
inline constexpr double kMargin_mm = 8.0;
inline constexpr double kHead_mm = 30.0;    ///< The head holds the title and the QR code.
inline constexpr double kFoot_mm = 14.0;    ///< The foot holds the ruler.
inline constexpr double kLabels_mm = 12.0;  ///< Labels outside of an island need this space around it.

/// Modules of one island at 1:1 on a page, seen from outside (the touch side).
struct IslandPage {
  int island = 0;
  /// An island that is larger than the paper has several pages, and every module is on one.
  int part = 0, parts = 1;
  /// The page is turned counter-clockwise by this many times 60°; an up tile lies up where it is even.
  int sixths = 0;
  design::Vec2 shift_mm{0, 0};    ///< It is the position of grid vertex (0, 0) on the page.
  std::vector<int> modules{};     ///< The ids are in ascending order.
  design::Vec2 caption_mm{0, 0};  ///< where its name and points stand on a page of several islands
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
  int patch = -1;  ///< controller whose QR code stands at the right of a title, −1: none
};

/// A label to print and stick: on a controller with its QR code, on both ends of a jumper without.
struct Label {
  int patch = -1;  ///< of the code, −1: none
  std::string name, first, second;
};
inline const design::Vec2 kLabel_mm{48.0, 20.0};

/// What a page shows.
enum class PageKind { kOverview, kKey, kText, kLabels, kIsland };
/// One page of the sheet.
struct Page {
  PageKind kind = PageKind::kText;
  std::string title{};
  int patch = -1;  ///< The page's QR code names this patch; −1 means that it has none.
  design::Vec2 size_mm{210, 297};
  std::vector<TextLine> lines{};      ///< They are the content of a text page.
  std::vector<IslandPage> islands{};  ///< content of an island page: one, or several small ones
  std::vector<Label> labels{};        ///< content of a page of labels
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
  std::vector<design::ModuleWiring> wiring;  ///< It is indexed by module.
  std::vector<Landmark> landmarks;
  std::vector<std::array<Anchor, 2>> anchors;  ///< It is indexed by island; the module is −1 if the island has none.
  std::vector<int> page_of_module;             ///< Each module is shown at 1:1 on this page, counted from 1.
  std::vector<Page> pages;
};
/// Smallest radius that the paper allows a module to be bent to, mm; places that ask for less are marked.
inline constexpr double kPaperBendRadius_mm = 50.0;
/// Radius to which a module is bent where one of its sides lies `depth_mm` under the drawn plane, mm; infinity for 0.
/// A side of 30 mm is a chord with that sagitta.
[[nodiscard]] double bend_radius_of_depth(double depth_mm);

/// Plans the sheet: overview, key, parts, order of work, labels, one table a controller, islands. Errors: InputError
/// for a design without modules. Cost: O(n log n) beside sides_of().
[[nodiscard]] Plan plan_of(const design::Design& design, Paper paper);

}  // namespace triskin::sheet

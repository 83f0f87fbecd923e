// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/base/names.hpp"
#include "triskin/design/design.hpp"
#include "triskin/design/supply.hpp"
#include "triskin/sheet/landmarks.hpp"
#include "triskin/sheet/sides.hpp"

namespace triskin::sheet {

enum class Paper {
  kA4,
  kA3,
  kRoll,  ///< The roll is 610 mm wide, each island takes the length it needs, and text pages are A4.
};
/// The command line uses these names: "A4", "A3", "roll".
inline constexpr NameTable kPaperNames{std::array<std::pair<Paper, std::string_view>, 3>{
    {{Paper::kA4, "A4"}, {Paper::kA3, "A3"}, {Paper::kRoll, "roll"}}}};

// Lengths on a page are in mm from its upper left corner, y downwards.
inline constexpr double kMargin_mm = 8.0;
inline constexpr double kHead_mm = 30.0;    ///< The head holds the title and the QR code.
inline constexpr double kFoot_mm = 14.0;    ///< The foot holds the ruler.
inline constexpr double kLabels_mm = 12.0;  ///< Labels outside of an island need this space around it.

/// Shows modules of one island at 1:1 on a page, seen from outside (the touch side).
struct IslandPage {
  int island = 0;
  /// An island that is larger than the paper has several pages, and every module is on one.
  int part = 0, parts = 1;
  /// The page is turned counter-clockwise by this many times 60°; if the number is even, an up tile points up.
  int sixths = 0;
  design::Vec2 shift_mm{0, 0};    ///< Grid vertex (0, 0) has this position on the page.
  std::vector<int> modules{};     ///< The ids are in ascending order.
  design::Vec2 caption_mm{0, 0};  ///< On a page of several islands, its name and points are written here.
  /// Returns the place of grid vertex (i, j) on the page, mm.
  [[nodiscard]] design::Vec2 at(const std::array<int, 2>& vertex) const;
  /// Returns the corners of a tile on the page, mm; counter-clockwise as seen on the paper.
  [[nodiscard]] std::array<design::Vec2, 3> corners_of(const design::Tile& tile) const;
};

enum class LineKind { kTitle, kText, kTick, kHead, kRow, kTickRow, kGap };
/// A line of a text page. Cells begin at `columns_mm` from the left margin; without columns there is one cell.
struct TextLine {
  LineKind kind = LineKind::kText;
  std::vector<std::string> cells;
  std::vector<double> columns_mm;
  int patch = -1;  ///< The QR code of this controller is at the right of a title; −1 shows none.
};

/// A label to print and stick: on a controller with its QR code, on both ends of a jumper without.
struct Label {
  int patch = -1;  ///< The code names this patch; −1 means that the label has no code.
  std::string name, first, second;
};
inline const design::Vec2 kLabel_mm{48.0, 20.0};

enum class PageKind { kOverview, kKey, kText, kLabels, kIsland };
struct Page {
  PageKind kind = PageKind::kText;
  std::string title{};
  int patch = -1;  ///< The page's QR code names this patch; −1 means that it has none.
  design::Vec2 size_mm{210, 297};
  std::vector<TextLine> lines{};      ///< Only a text page has these lines.
  std::vector<IslandPage> islands{};  ///< An island page shows one island, or several small ones.
  std::vector<Label> labels{};        ///< Only a page of labels has these.
};

/// A point of an island that is measured on the part: a corner of a module or, if corners are cut, the end of side
/// `corner` at it.
struct Anchor {
  int module = -1, corner = 0;
  Fix fix;
};

/// Holds everything that the pages show, before anything is drawn.
struct Plan {
  Sides sides;
  std::vector<design::ModuleWiring> wiring;  ///< The index is the module.
  std::vector<Landmark> landmarks;
  std::vector<std::array<Anchor, 2>> anchors;  ///< The index is the island; the module is −1 if the island has none.
  std::vector<int> page_of_module;             ///< Each module is shown at 1:1 on this page, counted from 1.
  design::SupplyModel supply;
  std::vector<double>
      supply_v;  ///< Each module has this voltage; below supply.needed_v() its patch needs a second feed.
  std::vector<Page> pages;
};
/// The paper allows no smaller bending radius of a module; places that need one are marked.
inline constexpr double kPaperBendRadius_mm = 50.0;
/// Returns the radius in mm to which a module is bent if one of its sides lies `depth_mm` under the drawn plane;
/// infinity for 0. A side of 30 mm is a chord with that sagitta.
[[nodiscard]] double bend_radius_of_depth(double depth_mm);

/// Plans the sheet: overview, key, parts, order of work, labels, one table per controller, islands. Errors: InputError
/// for a design without modules. Cost: O(n log n) beside sides_of().
[[nodiscard]] Plan plan_of(const design::Design& design, Paper paper, const design::SupplyModel& supply = {});

}  // namespace triskin::sheet

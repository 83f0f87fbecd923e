// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <numbers>
#include <optional>

#include "pages.hpp"

namespace triskin::sheet {

using design::Vec2;

Vec2 IslandPage::at(const std::array<int, 2>& vertex) const {
  const Vec2 p = Eigen::Rotation2Dd(sixths * std::numbers::pi / 3.0) * design::grid_point(vertex[0], vertex[1]);
  return shift_mm + Vec2(p.x(), -p.y());
}

std::array<Vec2, 3> IslandPage::corners_of(const design::Tile& tile) const {
  return {at(design::tile_corner_index(tile, 0)), at(design::tile_corner_index(tile, 1)),
          at(design::tile_corner_index(tile, 2))};
}

namespace {

constexpr double kRollWidth_mm = 610.0, kRollLongest_mm = 3000.0, kRollShortest_mm = 150.0;

// Divides an island on the paper into columns × rows of pages.
struct Division {
  int sixths = 0;
  Vec2 paper_mm{0, 0};
  Eigen::AlignedBox2d box;
  int columns = 1, rows = 1;
  [[nodiscard]] int pages() const { return columns * rows; }
};

Vec2 room_mm(const Vec2& paper_mm) {
  const double around = 2.0 * (kMargin_mm + kLabels_mm);
  return paper_mm - Vec2(around, around + kHead_mm + kFoot_mm);
}

// A module belongs to the part that contains its centre and may extend over its border, so a part is narrower than the
// room.
int parts_along(double length_mm, double room_mm) {
  return length_mm <= room_mm ? 1 : static_cast<int>(std::ceil(length_mm / (room_mm - design::kSide_mm)));
}

Eigen::AlignedBox2d box_of(const design::Design& design, const std::vector<int>& modules, const IslandPage& page) {
  Eigen::AlignedBox2d box;
  for (const int id : modules) {
    for (const Vec2& p : page.corners_of(design.layout.modules[static_cast<std::size_t>(id)].tile)) box.extend(p);
  }
  return box;
}

std::vector<Vec2> papers_of(Paper paper) {
  if (paper == Paper::kA4) return {{210, 297}, {297, 210}};
  if (paper == Paper::kA3) return {{297, 420}, {420, 297}};
  return {{kRollWidth_mm, kRollLongest_mm}};
}

Division divide(const design::Design& design, const std::vector<int>& modules, Paper paper) {
  std::vector<Division> ways;
  for (const Vec2& size_mm : papers_of(paper)) {
    for (int sixths = 0; sixths < 3; ++sixths) {
      Division way{sixths, size_mm, box_of(design, modules, {.sixths = sixths}), 1, 1};
      const Vec2 room = room_mm(size_mm);
      way.columns = parts_along(way.box.sizes().x(), room.x());
      way.rows = parts_along(way.box.sizes().y(), room.y());
      ways.push_back(way);
    }
  }
  const auto worse = [paper](const Division& d) {
    return std::pair(d.pages(), paper == Paper::kRoll ? d.box.sizes().y() : 0.0);
  };
  return *std::ranges::min_element(ways, {}, worse);  // Among equals the first wins, which is upright and not turned.
}

// Groups modules by the part that contains their centre, row by row.
std::map<int, std::vector<int>> parts_of(const design::Design& design, const std::vector<int>& modules,
                                         const Division& way) {
  std::map<int, std::vector<int>> parts;
  for (const int id : modules) {
    const Eigen::AlignedBox2d box = box_of(design, {id}, {.sixths = way.sixths});
    const Vec2 share = (box.center() - way.box.min()).cwiseQuotient(way.box.sizes());
    const int column = std::clamp(static_cast<int>(share.x() * way.columns), 0, way.columns - 1);
    const int row = std::clamp(static_cast<int>(share.y() * way.rows), 0, way.rows - 1);
    parts[row * way.columns + column].push_back(id);
  }
  return parts;
}

int common_patch(const std::vector<design::ModuleWiring>& wiring, const std::vector<int>& modules) {
  const int patch = wiring[static_cast<std::size_t>(modules.front())].patch;
  const auto same = [&](int id) { return wiring[static_cast<std::size_t>(id)].patch == patch; };
  return std::ranges::all_of(modules, same) ? patch : -1;
}

// A page while islands are put on it, in shelves from above.
struct OpenPage {
  struct Shelf {
    double top_mm = 0.0, height_mm = 0.0, used_mm = 0.0;
  };
  Vec2 room_mm{0, 0};
  std::vector<Shelf> shelves{};
  Page page{};

  // Returns the upper left corner of a free place, relative to that of the room; empty if there is none.
  std::optional<Vec2> place(const Vec2& cell_mm) {
    for (Shelf& shelf : shelves) {
      if (cell_mm.y() > shelf.height_mm || shelf.used_mm + cell_mm.x() > room_mm.x()) continue;
      const Vec2 at(shelf.used_mm, shelf.top_mm);
      shelf.used_mm += cell_mm.x();
      return at;
    }
    const double top = shelves.empty() ? 0.0 : shelves.back().top_mm + shelves.back().height_mm;
    if (top + cell_mm.y() > room_mm.y()) return std::nullopt;
    shelves.push_back({top, cell_mm.y(), cell_mm.x()});
    return Vec2(0, top);
  }
};

constexpr double kCaption_mm = 14.0;                            // The caption is an island's name and its two points.
constexpr double kCaptionWidth_mm = 93.0, kRulerRoom_mm = 8.0;  // Two captions and the ruler fill the width of A4.

// Returns the room that an island takes on a page that it shares.
Vec2 cell_of(const Vec2& box_mm) {
  return {std::max(box_mm.x() + 2.0 * kLabels_mm, kCaptionWidth_mm), box_mm.y() + 2.0 * kLabels_mm + kCaption_mm};
}

Vec2 shared_room(const Vec2& paper_mm) {
  return paper_mm - Vec2(2.0 * kMargin_mm + kRulerRoom_mm, 2.0 * kMargin_mm + kHead_mm + kFoot_mm);
}

void put_on(OpenPage& open, const Vec2& at_mm, const design::Design& design, IslandPage island) {
  const Eigen::AlignedBox2d box = box_of(design, island.modules, island);
  const Vec2 corner = Vec2(kMargin_mm, kMargin_mm + kHead_mm) + at_mm;
  island.caption_mm = corner + Vec2(0, 4.0);
  island.shift_mm += corner + Vec2(kLabels_mm, kLabels_mm + kCaption_mm) - box.min();
  open.page.islands.push_back(std::move(island));
}

// Small islands share pages: the tallest first, each in the first free place.
std::vector<Page> shared_pages(const design::Design& design, std::vector<Page> alone) {
  const auto size_of = [&](const Page& p) { return box_of(design, p.islands[0].modules, p.islands[0]).sizes().eval(); };
  std::ranges::stable_sort(alone, std::greater<>{}, [&](const Page& p) { return size_of(p).y(); });
  std::vector<OpenPage> open;
  for (Page& page : alone) {
    IslandPage island = std::move(page.islands[0]);
    const Vec2 cell = cell_of(box_of(design, island.modules, island).sizes());
    std::optional<Vec2> at;
    std::size_t k = 0;
    for (; k < open.size() && !(at = open[k].place(cell)); ++k) continue;
    if (!at) {
      open.push_back({.room_mm = shared_room(page.size_mm)});
      open.back().page = {.kind = PageKind::kIsland, .size_mm = page.size_mm};
      at = open.back().place(cell);
    }
    put_on(open[k], *at, design, std::move(island));
  }
  std::vector<Page> pages;
  for (OpenPage& o : open) {
    std::ranges::sort(o.page.islands, {}, &IslandPage::island);
    pages.push_back(std::move(o.page));
  }
  return pages;
}

std::string title_of(const Page& page) {
  const IslandPage& first = page.islands.front();
  if (first.parts > 1) return fmt::format("Island {}, part {} of {}", first.island, first.part + 1, first.parts);
  std::string text = page.islands.size() == 1 ? "Island" : "Islands";
  for (std::size_t k = 0; k < page.islands.size(); ++k)
    text += fmt::format("{} {}", k == 0 ? "" : ",", page.islands[k].island);
  return text;
}

Page page_alone(const design::Design& design, IslandPage island, const Division& way, Paper paper) {
  Page page{.kind = PageKind::kIsland, .size_mm = way.paper_mm};
  const Eigen::AlignedBox2d box = box_of(design, island.modules, island);
  if (paper == Paper::kRoll)
    page.size_mm.y() = std::max(kRollShortest_mm, box.sizes().y() + kRollLongest_mm - room_mm(way.paper_mm).y());
  const Vec2 corner(kMargin_mm + kLabels_mm, kMargin_mm + kHead_mm + kLabels_mm);
  island.shift_mm = corner + (room_mm(page.size_mm) - box.sizes()) / 2.0 - box.min();
  page.islands.push_back(std::move(island));
  return page;
}

// An island that takes at most half a page in one direction leaves room for another beside or below it.
bool may_share(const design::Design& design, const Page& page) {
  const IslandPage& island = page.islands[0];
  const Vec2 cell = cell_of(box_of(design, island.modules, island).sizes()), room = shared_room(page.size_mm);
  return island.parts == 1 && page.size_mm.y() > page.size_mm.x() && cell.x() <= room.x() &&
         cell.y() <= 0.75 * room.y();
}

}  // namespace

std::vector<Page> island_pages(const design::Design& design, Paper paper) {
  std::map<int, std::vector<int>> islands;
  for (std::size_t k = 0; k < design.layout.modules.size(); ++k)
    islands[design.layout.modules[k].island].push_back(static_cast<int>(k));
  const auto wiring = design::wiring_of(design);
  std::vector<Page> pages, small;
  for (const auto& [island, modules] : islands) {
    const Division way = divide(design, modules, paper);
    const auto parts = parts_of(design, modules, way);
    int part = 0;
    for (const auto& [place, members] : parts) {
      Page page = page_alone(
          design, {island, part++, static_cast<int>(parts.size()), way.sixths, {0, 0}, members, {0, 0}}, way, paper);
      auto& list = paper != Paper::kRoll && may_share(design, page) ? small : pages;
      list.push_back(std::move(page));
    }
  }
  for (Page& page : small) page.islands[0].shift_mm = {0, 0};
  std::ranges::move(shared_pages(design, std::move(small)), std::back_inserter(pages));
  std::ranges::stable_sort(pages, {}, [](const Page& p) { return p.islands.front().island; });
  for (Page& page : pages) {
    std::vector<int> all;
    for (const IslandPage& i : page.islands) all.insert(all.end(), i.modules.begin(), i.modules.end());
    page.patch = common_patch(wiring, all);
    page.title = title_of(page);
  }
  return pages;
}

}  // namespace triskin::sheet

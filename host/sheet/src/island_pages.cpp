// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "pages.hpp"

namespace triskin::sheet {

using design::Vec2;
using Box = Eigen::AlignedBox2d;

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

// How an island is divided on the paper: columns × rows of pages.
struct Division {
  int sixths = 0;
  Vec2 paper_mm{0, 0};
  Box box;
  int columns = 1, rows = 1;
  [[nodiscard]] int pages() const { return columns * rows; }
};

Vec2 room_mm(const Vec2& paper_mm) {
  const double around = 2.0 * (kMargin_mm + kLabels_mm);
  return paper_mm - Vec2(around, around + kHead_mm + kFoot_mm);
}

// A module belongs to the part that holds its centre and may stand over its border, so a part is narrower than the
// room.
int parts_along(double length_mm, double room_mm) {
  return length_mm <= room_mm ? 1 : static_cast<int>(std::ceil(length_mm / (room_mm - design::kSide_mm)));
}

Box box_of(const design::Design& design, const std::vector<int>& modules, const IslandPage& page) {
  Box box;
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

// Modules by the part that holds their centre, row by row.
std::map<int, std::vector<int>> parts_of(const design::Design& design, const std::vector<int>& modules,
                                         const Division& way) {
  std::map<int, std::vector<int>> parts;
  for (const int id : modules) {
    const Box box = box_of(design, {id}, {.sixths = way.sixths});
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

}  // namespace

std::vector<Page> island_pages(const design::Design& design, Paper paper) {
  std::map<int, std::vector<int>> islands;
  for (std::size_t k = 0; k < design.layout.modules.size(); ++k)
    islands[design.layout.modules[k].island].push_back(static_cast<int>(k));
  const auto wiring = design::wiring_of(design);
  std::vector<Page> pages;
  for (const auto& [island, modules] : islands) {
    const Division way = divide(design, modules, paper);
    const auto parts = parts_of(design, modules, way);
    int part = 0;
    for (const auto& [place, members] : parts) {
      Page page{.kind = PageKind::kIsland, .size_mm = way.paper_mm};
      page.island = {island, part++, static_cast<int>(parts.size()), way.sixths, {0, 0}, members};
      const Box box = box_of(design, members, page.island);
      if (paper == Paper::kRoll)
        page.size_mm.y() = std::max(kRollShortest_mm, box.sizes().y() + kRollLongest_mm - room_mm(way.paper_mm).y());
      const Vec2 corner(kMargin_mm + kLabels_mm, kMargin_mm + kHead_mm + kLabels_mm);
      page.island.shift_mm = corner + (room_mm(page.size_mm) - box.sizes()) / 2.0 - box.min();
      page.patch = common_patch(wiring, members);
      page.title = parts.size() == 1 ? fmt::format("Island {}", island)
                                     : fmt::format("Island {}, part {} of {}", island, part, parts.size());
      pages.push_back(std::move(page));
    }
  }
  return pages;
}

}  // namespace triskin::sheet

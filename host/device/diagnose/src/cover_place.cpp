// SPDX-License-Identifier: GPL-3.0-or-later
#include "cover_place.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace triskin::diagnose {
namespace {

// Counts half columns: an up tile lies left of the down tile of the same (i, j).
int column(const design::Tile& t) {
  return 2 * t.i + (t.up ? 0 : 1);
}

}  // namespace

std::string place_on_cover(const design::Design& design, layout::ModuleId module) {
  const design::PlacedModule& own = design.layout.modules.at(static_cast<std::size_t>(module));
  std::set<int> rows, columns;
  for (const design::PlacedModule& m : design.layout.modules) {
    if (m.island != own.island) continue;
    rows.insert(m.tile.j);
    if (m.tile.j == own.tile.j) columns.insert(column(m.tile));
  }
  const auto row = std::distance(rows.begin(), rows.find(own.tile.j)) + 1;
  const auto at = static_cast<std::size_t>(std::distance(columns.begin(), columns.find(column(own.tile)))) + 1;
  const std::string side = columns.size() == 1    ? "alone"
                           : at == 1              ? "left rim"
                           : at == columns.size() ? "right rim"
                                                  : fmt::format("{} of {} from the left", at, columns.size());
  return fmt::format("island {}, row {} of {}, {}", own.island, row, rows.size(), side);
}

std::string joint_text(const design::Design& design, layout::ModuleId module, layout::ModuleId other) {
  const auto end = [&](int of, int towards) {
    const auto& neighbour = design.layout.modules.at(static_cast<std::size_t>(of)).neighbour;
    const auto side = std::ranges::find(neighbour, towards);
    const design::ModuleNumber number = design::number_of(design, of);
    return side == neighbour.end() ? fmt::format("module {}", number)
                                   : fmt::format("module {} (side {})", number, side - neighbour.begin());
  };
  return fmt::format("the joint of {} and {}", end(module, other), end(other, module));
}

}  // namespace triskin::diagnose

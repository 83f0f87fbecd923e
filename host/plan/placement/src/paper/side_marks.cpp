// SPDX-License-Identifier: GPL-3.0-or-later
#include "paper/side_marks.hpp"

#include <algorithm>
#include <cmath>

namespace triskin::placement::paper {

void SideMarks::reset(const GridFrame& frame) {
  constexpr int kMargin = 2;  // This many modules are added beside a line that touches the polygon's box.
  const auto [low_u, high_u] = std::ranges::minmax(frame.u());
  const auto [low_v, high_v] = std::ranges::minmax(frame.v());
  first_i_ = static_cast<int>(std::floor(low_u)) - kMargin;
  first_j_ = static_cast<int>(std::floor(low_v)) - kMargin;
  columns_ = static_cast<int>(std::ceil(high_u)) + kMargin - first_i_;
  const int rows = static_cast<int>(std::ceil(high_v)) + kMargin - first_j_;
  bits_.assign(static_cast<std::size_t>(2 * rows) * static_cast<std::size_t>(columns_), 0);
}

int SideMarks::count() const {
  return static_cast<int>(std::ranges::count(bits_, kContained));
}

std::vector<Tile> SideMarks::contained() const {
  std::vector<Tile> tiles;
  for (std::size_t k = 0; k < bits_.size(); ++k) {
    if (bits_[k] != kContained) continue;
    const int cell = static_cast<int>(k / 2);
    tiles.push_back({first_i_ + cell % columns_, first_j_ + cell / columns_, k % 2 == 1});
  }
  std::ranges::sort(tiles);
  return tiles;
}

}  // namespace triskin::placement::paper

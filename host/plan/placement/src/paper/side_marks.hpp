// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "paper/grid_frame.hpp"

namespace triskin::placement::paper {

/// Marks the contained sides among the three of each module of a window around the polygon (ns_j of Algorithm 1). Each
/// direction has one bit, so a side that lies in an interval and on an edge counts once.
class SideMarks {
 public:
  void reset(const GridFrame& frame);

  /// Marks the side on `line` of `direction` from node `at` along the line to the next, for its two modules.
  void mark(std::size_t direction, int line, int at) {
    switch (direction) {
      case 0:
        bits(at, line, true) |= 1;
        bits(at, line - 1, false) |= 1;
        break;
      case 1:
        bits(line, at, true) |= 2;
        bits(line - 1, at, false) |= 2;
        break;
      default:
        bits(line - 1 - at, at, true) |= 4;
        bits(line - 1 - at, at, false) |= 4;
        break;
    }
  }
  /// Excludes a module, whatever its sides say.
  void reject(const Tile& tile) { bits(tile.i, tile.j, tile.up) |= kRejected; }

  [[nodiscard]] int count() const;
  /// Returns the contained modules, sorted.
  [[nodiscard]] std::vector<Tile> contained() const;

 private:
  static constexpr std::uint8_t kContained = 7, kRejected = 8;

  [[nodiscard]] std::uint8_t& bits(int i, int j, bool up) {
    return bits_[static_cast<std::size_t>(((j - first_j_) * columns_ + i - first_i_) * 2 + (up ? 1 : 0))];
  }

  int first_i_ = 0, first_j_ = 0, columns_ = 0;
  std::vector<std::uint8_t> bits_;
};

}  // namespace triskin::placement::paper

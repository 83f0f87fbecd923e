// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace triskin::geometry {

/// level + x·δx + y·δy + theta·δθ ≥ 0, where δ is the offset from the centre of a cell: a tile needs it
/// inside the cell. A tile needs all its pairs, a pair one of its directions, a direction all its half spaces; `ends`
/// says where one ends.
struct HalfSpace {
  static constexpr std::uint32_t kEndDirection = 1, kEndPair = 2, kEndTile = 4;
  double level = 0.0, x = 0.0, y = 0.0, theta = 0.0;
  std::uint32_t ends = 0;
};

/// A cell is cut into 4 × 4 × 4 parts, in rows of 16 lanes: lane x + 4·y, row theta.
inline constexpr int kPartsPerAxis = 4, kLanesPerRow = 16;

/// State of a tile in each part: for each lane bit `row` where it may hold, bit 16 + `row` where it holds for certain.
using PartWord = std::array<std::uint32_t, kLanesPerRow>;

struct PartsView {
  std::array<double, 3> shift{};  ///< It is the centre of the cell, seen from where the half spaces were made.
  std::array<double, 3> half{};   ///< They are the half widths of the cell.
  double sure_mm = 0.0;  ///< Where the level exceeds this plus the spread of a part, the constraint cannot fail.
};

/// Number of tiles that can hold somewhere in each part: a bound for many cells for little more than the price of one.
/// Rounding only ever adds tiles. The widest instruction set of the processor is chosen at the first call; all give the
/// same bits. One object a thread: it keeps its memory.
class Lookahead {
 public:
  /// Fills one word per tile.
  void run(const PartsView& view, std::span<const HalfSpace> halves, std::vector<PartWord>& words);

  [[nodiscard]] int count(int x, int y, int theta) const {
    return counts_[static_cast<std::size_t>(x + kPartsPerAxis * (y + kPartsPerAxis * theta))];
  }

  /// Half space in single precision, seen from one cell.
  struct Sharp {
    float level, x, y, theta, sure;
    std::uint32_t ends;
  };

 private:
  std::vector<Sharp> sharp_;
  alignas(64) std::array<std::int32_t, kPartsPerAxis * kLanesPerRow> counts_{};
};

}  // namespace triskin::geometry

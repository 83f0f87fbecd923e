// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace triskin::placement {

/// The constraint level + x·δx + y·δy + theta·δθ ≥ 0, with δ the offset from the centre of a cell. A tile
/// needs all its pairs, a pair needs one of its directions, a direction needs all its half spaces; `ends` tells where
/// one ends.
struct HalfSpace {
  static constexpr std::uint32_t kEndDirection = 1, kEndPair = 2, kEndTile = 4;
  double level = 0.0, x = 0.0, y = 0.0, theta = 0.0;
  std::uint32_t ends = 0;
};

/// A cell is cut into 4 × 4 × 4 parts, in rows of 16 lanes: lane x + 4·y, row theta.
inline constexpr int kPartsPerAxis = 4, kLanesPerRow = 16;

/// State of a tile in each part: for each lane, bit `row` tells where it may hold, bit 16 + `row` where it holds for
/// certain.
using PartWord = std::array<std::uint32_t, kLanesPerRow>;

struct PartsView {
  std::array<double, 3> shift{};  ///< The shift leads from where the half spaces were made to the centre of the cell.
  std::array<double, 3> half{};   ///< The half widths of the cell.
  double sure_mm = 0.0;           ///< If the level exceeds this plus the spread of a part, the constraint cannot fail.
};

/// Counts the tiles that can hold somewhere in each part, which bounds many cells for little more than the cost of one.
/// Rounding only ever adds tiles. The widest instruction set of the processor is chosen at the first call; all give the
/// same bits. Keeps its memory, so each thread needs its own object.
class Lookahead {
 public:
  /// Fills one word per tile.
  void run(const PartsView& view, std::span<const HalfSpace> halves, std::vector<PartWord>& words);

  [[nodiscard]] int count(int x, int y, int theta) const {
    return counts_[static_cast<std::size_t>(x + kPartsPerAxis * (y + kPartsPerAxis * theta))];
  }

  /// A half space in single precision, relative to one cell.
  struct Sharp {
    float level, x, y, theta, sure;
    std::uint32_t ends;
  };

 private:
  std::vector<Sharp> sharp_;
  alignas(64) std::array<std::int32_t, kPartsPerAxis * kLanesPerRow> counts_{};
};

}  // namespace triskin::placement

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

namespace triskin::geometry {

/// Bounds of a convex figure on a grid of samples: column ≥ (or ≤) at + slope·row.
struct BoundLines {
  struct Line {
    float at, slope;
  };
  std::vector<Line> lower, upper;
};

/// Whole columns [begin, end) of rows 0 … rows − 1 between the bounds; begin ≥ end: none. Columns below 0 are
/// cut off. `room`: 0 keeps strictly inside, 1 takes up to one more sample on either side. The widest instruction set
/// is chosen at the first call; all give the same columns.
void row_spans(const BoundLines& lines, int rows, int room, std::vector<std::int32_t>& begin,
               std::vector<std::int32_t>& end);

}  // namespace triskin::geometry

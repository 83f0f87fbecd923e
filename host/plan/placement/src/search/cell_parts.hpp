// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "kernels/pair_kernel.hpp"
#include "search/lookahead.hpp"

namespace triskin::placement {

/// Names a part of a cell that is divided along x, y and theta.
using PartIndex = std::array<int, 3>;

/// Returns the box of the parts low ≤ index < high; outer faces keep their bits, so that neighbours fit together.
[[nodiscard]] inline MotionBox part_box(const MotionBox& box, const PartIndex& parts, const PartIndex& low,
                                        const PartIndex& high) {
  MotionBox part = box;
  for (std::size_t k = 0; k < 3; ++k) {
    const double step = (box.high[k] - box.low[k]) / parts[k];
    if (low[k] > 0) part.low[k] = box.low[k] + step * low[k];
    if (high[k] < parts[k]) part.high[k] = box.low[k] + step * high[k];
  }
  return part;
}

/// Returns the half extents of a box in mm; `radius_mm` is how far the polygon reaches from the centre of its turns.
[[nodiscard]] inline std::array<double, 3> half_extents_mm(const MotionBox& box, double radius_mm) {
  return {box.half(0), box.half(1), radius_mm * box.half(2)};
}

/// Returns the axis of the largest extent among those along which there are several parts. There must be such an axis.
[[nodiscard]] inline std::size_t longest_axis(const std::array<double, 3>& extents_mm, const PartIndex& parts) {
  std::size_t axis = 3;
  for (std::size_t k = 0; k < 3; ++k) {
    if (parts[k] > 1 && (axis == 3 || extents_mm[k] > extents_mm[axis])) axis = k;
  }
  return axis;
}

/// Returns the part of a slice with the highest bound(x, y), the first one among equals.
template <class BoundOf>
[[nodiscard]] PartIndex best_part(const PartIndex& parts, const BoundOf& bound) {
  PartIndex best{};
  for (int x = 0; x < parts[0]; ++x) {
    for (int y = 0; y < parts[1]; ++y) {
      if (bound(x, y) > bound(best[0], best[1])) best = {x, y, 0};
    }
  }
  return best;
}

/// Takes back in which parts tiles hold for certain unless their centre is inside in the whole cell: such a tile is
/// free of all edges there, but it may be outside.
inline void forget_certain_outside(const std::vector<OpenTile>& tiles, std::vector<PartWord>& words) {
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    if (tiles[t].inside) continue;
    for (std::uint32_t& word : words[t]) word &= 0xffffU;
  }
}

/// Returns the bits of the parts low ≤ index < high in the words of tiles.
[[nodiscard]] inline PartWord wanted_parts(const PartIndex& low, const PartIndex& high) {
  PartWord wanted{};
  for (int x = low[0]; x < high[0]; ++x) {
    for (int y = low[1]; y < high[1]; ++y)
      wanted[static_cast<std::size_t>(x + kPartsPerAxis * y)] = (1U << high[2]) - (1U << low[2]);
  }
  return wanted;
}

/// Returns how the parts of a box lie to the constraints that were made for the frame, of whose cell the box is a part.
[[nodiscard]] inline PartsView parts_view(const CellFrame& frame, const MotionBox& box) {
  PartsView view{.shift = {}, .half = {}, .sure_mm = frame.certain_mm - frame.inset_mm + 2.0 * frame.pad_mm};
  for (std::size_t k = 0; k < 3; ++k) {
    view.shift[k] = box.center(k) - frame.center[k];
    view.half[k] = box.half(k) * (1.0 + 1e-12) + 1e-15;
  }
  return view;
}

/// Summarizes the open ones among some parts: the least box around them, their number and their highest bound.
template <class Bound>
struct OpenParts {
  PartIndex low{99, 99, 99}, high{0, 0, 0};
  int count = 0;
  Bound most{};
  [[nodiscard]] PartIndex size() const { return {high[0] - low[0], high[1] - low[1], high[2] - low[2]}; }
  /// Returns true if the box has at most max_parts parts and at least half of them are open; it is then not divided.
  [[nodiscard]] bool well_filled(int max_parts) const {
    const int volume = size()[0] * size()[1] * size()[2];
    return volume <= max_parts && count * 2 >= volume;
  }
  /// Returns the first corner past the lower half along an axis, and the low corner of the upper half.
  [[nodiscard]] std::pair<PartIndex, PartIndex> halves(std::size_t axis) const {
    PartIndex first_high = high, second_low = low;
    first_high[axis] = second_low[axis] = low[axis] + size()[axis] / 2;
    return {first_high, second_low};
  }
};

/// Finds the open ones among the parts low ≤ index < high. bound(x, y, t) returns the bound of a part, is_open(bound)
/// tells whether it may hold something better.
template <class BoundOf, class IsOpen>
[[nodiscard]] auto open_parts(const PartIndex& low, const PartIndex& high, const BoundOf& bound,
                              const IsOpen& is_open) {
  OpenParts<decltype(bound(0, 0, 0))> open;
  for (int t = low[2]; t < high[2]; ++t) {
    for (int y = low[1]; y < high[1]; ++y) {
      for (int x = low[0]; x < high[0]; ++x) {
        const auto here = bound(x, y, t);
        if (!is_open(here)) continue;
        const PartIndex at{x, y, t};
        for (std::size_t k = 0; k < 3; ++k) {
          open.low[k] = std::min(open.low[k], at[k]);
          open.high[k] = std::max(open.high[k], at[k] + 1);
        }
        ++open.count;
        open.most = std::max(open.most, here);
      }
    }
  }
  return open;
}

}  // namespace triskin::placement

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <vector>

#include "silhouette.hpp"

namespace triskin::fabrication {

/// An island on its sheet; its rings are turned already and move by `shift_mm`.
struct Body {
  std::vector<Ring> rings_mm;
  int sheet = 0;
  design::Vec2 shift_mm{0, 0};
};

struct CompactionRoom {
  double width_mm = 0.0, length_mm = 0.0;  ///< The size of a sheet.
  double gap_mm = 0.0;                     ///< Bodies keep this distance from each other and from the edges.
};

/// Pushes bodies that are too near apart and the last sheet together, by exact distances and without turning them.
/// Bodies must lie nearly right: none may reach more than 0.7 mm into another. Returns the shifts of the shortest
/// layout found, or nothing if the gap cannot be kept within the sheet. What is returned keeps every gap exactly.
/// Deterministic. Cost: about 0.2 s for 14 islands of 150 modules.
[[nodiscard]] std::optional<std::vector<design::Vec2>> compacted(std::vector<Body> bodies, const CompactionRoom& room);

}  // namespace triskin::fabrication

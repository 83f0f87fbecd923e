// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "board_art.hpp"
#include "triskin/fabrication/nesting.hpp"

/// What is uploaded: one panel for each sheet of islands, with a frame around them.
namespace triskin::fabrication {

/// Fabricators of flexible boards take panels up to about this size (design notes cite 229 × 356 mm).
inline constexpr double kMaxPanelWidth_mm = 229.0, kMaxPanelLength_mm = 356.0;

struct NamedFile {
  std::string name, bytes;
};

struct Panel {
  std::string name;  ///< panel_1 …
  design::Vec2 size_mm{0, 0};
  std::vector<NamedFile> board;     ///< Gerber X2 of every layer, Excellon, notes
  std::vector<NamedFile> assembly;  ///< bill of materials, positions, and the layers that an assembly house looks at
};

/// Returns the panel of sheet `sheet`. `art` has the copper of each island, in the order of the islands. The panel's
/// origin is the lower left corner of its frame, seen from the touch side. The frame has three fiducials and four
/// tooling holes; islands hang on it, and on each other, by tabs where their outline is not cut. Cost: linear.
[[nodiscard]] Panel panel_of(const std::vector<FlatIsland>& islands, const std::vector<BoardArt>& art,
                             const Nesting& nesting, int sheet);

}  // namespace triskin::fabrication

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "triskin/design/design.hpp"

namespace triskin::sheet {

/// Tells what a person does with a side of a module when building the patch.
enum class SideKind {
  kOutline,  ///< No module lies beside it in the lattice, so it is cut through.
  kSlit,     ///< A module lies beside it in the lattice and is not joined, so it is cut through.
  kKept,     ///< The joint carries the lines and is folded.
  kCut,      ///< The joint lies inside a patch and carries none: its traces are cut, and it is folded.
  kApart,    ///< The joint lies between two controllers: its traces are cut, and it is folded.
};

struct Side {
  SideKind kind = SideKind::kOutline;
  int other = -1;  ///< The module beside it in the lattice, kSlit included, or −1.
  /// Seen from the touch side, joints with a positive angle fold away from the viewer, those with a negative one
  /// towards.
  double fold_rad = 0;
  /// The index refers to Sides::matches; −1 means that the side faces no other free side.
  int match = -1;
  int jumper = -1;            ///< The index refers to ModuleLayout::jumpers; −1 stands for none.
  bool cable = false;         ///< The cable of the controller is plugged in here.
  bool second_cable = false;  ///< Only a patch of switched modules has a second cable.
};

/// Two free sides that face each other across a seam of the cover get the same mark.
struct Match {
  std::array<int, 2> module{-1, -1};  ///< The lower id comes first.
  std::array<int, 2> side{0, 0};
  double gap_mm = 0;  ///< The gap is measured straight between the middles of the sides.
};

/// Sides whose middles are farther apart get no mark.
inline constexpr double kFarthestMatch_mm = 15.0;

/// Gives the sides by module id, and the marks of all seams.
struct Sides {
  std::vector<std::array<Side, 3>> of;
  std::vector<Match> matches;  ///< Matches are ordered by module and side.
};
/// Returns the sides of all modules of a design. Free sides without a jumper match when each is the other's nearest,
/// their middles lie at most kFarthestMatch_mm apart and their outward directions more than 120° apart (degrees).
/// Throws std::out_of_range for a patch or jumper of a module that the design lacks. Cost: O(n + free sides²).
[[nodiscard]] Sides sides_of(const design::Design& design);

}  // namespace triskin::sheet

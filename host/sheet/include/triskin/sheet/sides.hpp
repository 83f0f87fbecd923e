// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "triskin/design/design.hpp"

namespace triskin::sheet {

/// What is done with a side of a module when the patch is built.
enum class SideKind {
  kOutline,  ///< Nothing lies beside it in the lattice, so it is cut through.
  kSlit,     ///< A module lies beside it in the lattice and is not joined, so it is cut through.
  kKept,     ///< The joint carries the lines and is folded.
  kCut,      ///< The joint lies inside a patch and carries none: its traces are cut, and it is folded.
  kApart,    ///< The joint lies between two controllers: its traces are cut, and it is folded.
};

/// One side of one module.
struct Side {
  SideKind kind = SideKind::kOutline;
  int other = -1;  ///< It is the module beside it in the lattice, kSlit included, or −1.
  /// Joints fold away from who looks at the touch side if it is positive, and towards if negative.
  double fold_rad = 0;
  int match = -1;             ///< It indexes Sides::matches; −1 means that the side faces no other free side.
  int jumper = -1;            ///< It indexes ModuleLayout::jumpers; −1 stands for none.
  bool cable = false;         ///< The cable of the controller is plugged in here.
  bool second_cable = false;  ///< It is the second cable of a patch of switched modules.
};

/// Two free sides that face each other across a seam of the cover: they get the same mark.
struct Match {
  std::array<int, 2> module{-1, -1};  ///< The lesser one comes first.
  std::array<int, 2> side{0, 0};
  double gap_mm = 0;  ///< It is measured straight between the middles of the sides.
};

/// Farthest that the middles of two sides lie apart for a mark, mm.
inline constexpr double kFarthestMatch_mm = 15.0;

/// Sides by module id, and the marks of all seams.
struct Sides {
  std::vector<std::array<Side, 3>> of;
  std::vector<Match> matches;  ///< They are ordered by module and side.
};
/// Sides of all modules of a design. Free sides without a jumper match when each is the other's nearest, their middles
/// lie at most kFarthestMatch_mm apart and their outward directions more than 120° apart (degrees). Throws
/// std::out_of_range for a patch or jumper of a module that the design lacks. Cost: O(n + free sides²).
[[nodiscard]] Sides sides_of(const design::Design& design);

/// Middle of side `side` (0 … 2) of a module, mesh frame, mm.
[[nodiscard]] design::Vec3 middle_of(const design::PlacedModule& module, int side);

}  // namespace triskin::sheet

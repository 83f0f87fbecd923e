// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "triskin/design/design.hpp"

namespace triskin::sheet {

/// What is done with a side of a module when the patch is built.
enum class SideKind {
  kOutline,  ///< nothing beside it in the lattice: cut through
  kSlit,     ///< a module lies beside it in the lattice and is not joined: cut through
  kKept,     ///< joint that carries the lines: fold
  kCut,      ///< joint inside a patch that carries none: cut its traces, fold
  kApart,    ///< joint between two controllers: cut its traces, fold
};

/// One side of one module.
struct Side {
  SideKind kind = SideKind::kOutline;
  int other = -1;             ///< module beside it in the lattice (kSlit, too), −1: none
  double fold_rad = 0;        ///< joints only; above 0: away from who looks at the touch side, below 0: towards
  int match = -1;             ///< index in Sides::matches, −1: faces no other free side
  int jumper = -1;            ///< index in ModuleLayout::jumpers, −1: none
  bool cable = false;         ///< the cable of the controller is plugged in here
  bool second_cable = false;  ///< the second cable of a patch of switched modules
};

/// Two free sides that face each other across a seam of the cover: they get the same mark.
struct Match {
  std::array<int, 2> module{-1, -1};  ///< the lesser first
  std::array<int, 2> side{0, 0};
  double gap_mm = 0;  ///< straight, between the middles of the sides
};

/// Farthest that the middles of two sides lie apart for a mark, mm.
inline constexpr double kFarthestMatch_mm = 15.0;

/// Sides by module id, and the marks of all seams.
struct Sides {
  std::vector<std::array<Side, 3>> of;
  std::vector<Match> matches;  ///< ordered by module and side
};
/// Sides of all modules of a design. Free sides without a jumper match when each is the other's nearest, their middles
/// lie at most kFarthestMatch_mm apart and their outward directions more than 120° apart (degrees). Throws
/// std::out_of_range for a patch or jumper of a module that the design lacks. Cost: O(n + free sides²).
[[nodiscard]] Sides sides_of(const design::Design& design);

/// Middle of side `side` (0 … 2) of a module, mesh frame, mm.
[[nodiscard]] design::Vec3 middle_of(const design::PlacedModule& module, int side);

}  // namespace triskin::sheet

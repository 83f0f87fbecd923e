// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "triskin/design/design_types.hpp"

namespace triskin::testing {

/// What a person says of a part.
enum class SideTruth : std::uint8_t {
  kTold,    ///< One side is the outer one.
  kAlike,   ///< Both sides look alike: a question is right, and so is no other answer.
  kNoWall,  ///< A surface or a body without a wall: all of it stays.
};

/// A part made by code, with the side of each of its faces by construction.
struct WalledPart {
  std::string name;
  geometry::Mesh mesh;
  std::vector<int> side;  ///< a face each: 1 outer, −1 inner, 0 between (rims, walls of holes)
  SideTruth truth = SideTruth::kTold;
};

/// Trays, rings, half shells, boxes with a lid, ribs, bosses, honeycombs, engraved letters, fillets, screw holes,
/// two-part shells, lids that are alike on both sides, scans: closed solids with walls of 1 … 5 mm unless the name
/// says otherwise. Always the same.
[[nodiscard]] std::vector<WalledPart> walled_parts();

}  // namespace triskin::testing

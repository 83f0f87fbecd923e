// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "triskin/design/design_types.hpp"

namespace triskin::testing {

/// States how a person judges the part.
enum class SideTruth : std::uint8_t {
  kTold,    ///< One side is clearly the outer one.
  kAlike,   ///< Both sides look alike: only a question is right, and any other answer is wrong.
  kNoWall,  ///< The surface or body has no wall, so all of it stays.
};

/// A part made by code, with the side of each of its faces by construction.
struct WalledPart {
  std::string name;
  design::Mesh mesh;
  std::vector<int> side;  ///< Each face has 1 for outer, −1 for inner, 0 for between (rims, walls of holes).
  SideTruth truth = SideTruth::kTold;
};

/// Makes trays, rings, half shells, boxes with a lid, ribs, bosses, honeycombs, engraved letters, fillets, screw holes,
/// two-part shells, lids that are alike on both sides, scans: closed solids with walls of 1 … 5 mm unless the name
/// says otherwise. The result is always the same.
[[nodiscard]] std::vector<WalledPart> walled_parts();

/// The kinds of random_walled_part(), 0 … kRandomKinds − 1.
inline constexpr int kRandomKinds = 16;
/// Makes a part of one kind with random sizes, walls of 1 … 3.5 mm, ribs, bosses, holes and letters. Its name is the
/// kind with the seed. The result is always the same for equal arguments. Errors: std::out_of_range for another kind.
[[nodiscard]] WalledPart random_walled_part(int kind, unsigned seed);

}  // namespace triskin::testing

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/sheet/sides.hpp"

namespace triskin::sheet {

/// How many pieces of one length.
struct PieceCount {
  int length_mm = 0;  ///< 0: unknown
  int count = 0;
  bool operator==(const PieceCount&) const = default;
};

/// Bill of materials, and how much work there is.
struct Bill {
  int modules = 0;
  std::vector<int> modules_by_kind;     ///< indexed by kind, the standard one first
  std::array<int, 4> line_straps{};     ///< straps that set each line
  std::array<int, 4> address_straps{};  ///< straps that set each address
  int controllers = 0;
  /// Cables to the entries by length, shortest first: from the entry straight to the nearest point of a rim, rounded up
  /// to 10 mm; what lies beyond the rim has to be added. Length 0 where the part has no rim.
  std::vector<PieceCount> cables;
  std::vector<PieceCount> second_cables;  ///< the same for second entries, which only switched modules can use
  std::vector<PieceCount> jumpers;        ///< sorted by length along the surface, rounded up to 1 mm
  int kept_joints = 0;                    ///< number of joints that stay, without jumpers
  int cut_joints = 0;                     ///< number of joints cut inside a patch
  int apart_joints = 0;                   ///< number of joints cut between two controllers
  int slits = 0;
};
/// Counts what a design needs. `sides`: of the same design. Errors: none for a design that was read or made. Cost:
/// O(n + patches · faces).
[[nodiscard]] Bill bill_of(const design::Design& design, const Sides& sides);

}  // namespace triskin::sheet

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
  std::vector<int> modules_by_kind;     ///< by number of the kind, the standard one first
  std::array<int, 4> line_straps{};     ///< by line
  std::array<int, 4> address_straps{};  ///< by address
  int controllers = 0;
  /// Cables to the entries by length, shortest first: from the entry straight to the nearest point of a rim, rounded up
  /// to 10 mm; what lies beyond the rim has to be added. Length 0 where the part has no rim.
  std::vector<PieceCount> cables;
  std::vector<PieceCount> second_cables;  ///< the same of the second entries, which only switched modules can use
  std::vector<PieceCount> jumpers;        ///< by length along the surface, rounded up to 1 mm
  int kept_joints = 0;                    ///< without jumpers
  int cut_joints = 0;                     ///< inside a patch
  int apart_joints = 0;                   ///< between two controllers
  int slits = 0;
};
/// Counts what a design needs. `sides`: of the same design. Errors: none for a design that was read or made. Cost:
/// O(n + patches · faces).
[[nodiscard]] Bill bill_of(const design::Design& design, const Sides& sides);

}  // namespace triskin::sheet

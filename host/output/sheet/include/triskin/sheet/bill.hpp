// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/sheet/sides.hpp"

namespace triskin::sheet {

/// Counts the pieces of one length.
struct PieceCount {
  int length_mm = 0;  ///< Zero means that the length is unknown.
  int count = 0;
  bool operator==(const PieceCount&) const = default;
};

/// Lists the materials of a design, and how much work it takes.
struct Bill {
  int modules = 0;
  std::vector<int> modules_by_kind;     ///< The index is the kind, the standard one first.
  std::array<int, 4> line_straps{};     ///< Each line is set by this number of straps.
  std::array<int, 4> address_straps{};  ///< Each address is set by this number of straps.
  int controllers = 0;
  /// Cables to the entries by length, shortest first: from the entry straight to the nearest point of a rim, rounded up
  /// to 10 mm; the way beyond the rim has to be added. Length 0 if the part has no rim.
  std::vector<PieceCount> cables;
  /// Only switched modules can use these cables of second entries.
  std::vector<PieceCount> second_cables;
  std::vector<PieceCount> jumpers;  ///< Jumpers are sorted by their length along the surface, rounded up to 1 mm.
  int kept_joints = 0;              ///< These joints stay; jumpers are not counted.
  int cut_joints = 0;               ///< These joints are cut inside a patch.
  int apart_joints = 0;             ///< These joints are cut between two controllers.
  int slits = 0;
};
/// Counts the parts and the work of a design. `sides` must belong to the same design. Errors: none for a design that
/// was read or made. Cost: O(n + patches · faces).
[[nodiscard]] Bill bill_of(const design::Design& design, const Sides& sides);

}  // namespace triskin::sheet

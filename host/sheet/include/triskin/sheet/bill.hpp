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
  std::vector<int> modules_by_kind;     ///< It is indexed by kind, the standard one first.
  std::array<int, 4> line_straps{};     ///< So many straps set each line.
  std::array<int, 4> address_straps{};  ///< So many straps set each address.
  int controllers = 0;
  /// Cables to the entries by length, shortest first: from the entry straight to the nearest point of a rim, rounded up
  /// to 10 mm; what lies beyond the rim has to be added. Length 0 where the part has no rim.
  std::vector<PieceCount> cables;
  /// They are the cables of second entries, which only switched modules can use.
  std::vector<PieceCount> second_cables;
  std::vector<PieceCount> jumpers;  ///< They are sorted by their length along the surface, rounded up to 1 mm.
  int kept_joints = 0;              ///< So many joints stay, without jumpers.
  int cut_joints = 0;               ///< So many joints are cut inside a patch.
  int apart_joints = 0;             ///< So many joints are cut between two controllers.
  int slits = 0;
};
/// Counts what a design needs. `sides`: of the same design. Errors: none for a design that was read or made. Cost:
/// O(n + patches · faces).
[[nodiscard]] Bill bill_of(const design::Design& design, const Sides& sides);

}  // namespace triskin::sheet

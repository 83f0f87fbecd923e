// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/fabrication/flat_island.hpp"
#include "triskin/sheet/sides.hpp"

namespace triskin::fabrication {

/// One line of what has to be bought or made.
struct PartLine {
  std::string part;  ///< what it is
  int quantity = 0;
  std::string manufacturer;  ///< empty: of any
  std::string part_number;   ///< order number of the manufacturer, which distributors use; our own for boards
  std::string note;
};

/// Boards, chips, capacitors, controllers and cables of a design. `sides`, `islands`: of the same design. Errors: none
/// for a design that was read or made. Cost: O(n + patches · faces).
[[nodiscard]] std::vector<PartLine> parts_of(const design::Design& design, const sheet::Sides& sides,
                                             const std::vector<FlatIsland>& islands);

/// The list as CSV (RFC 4180): part,quantity,manufacturer,part_number,note. Cost: linear.
[[nodiscard]] std::string parts_csv(const std::vector<PartLine>& parts);

}  // namespace triskin::fabrication

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/fabrication/flat_island.hpp"
#include "triskin/sheet/sides.hpp"

namespace triskin::fabrication {

/// One line of parts that have to be bought or made.
struct PartLine {
  std::string part;  ///< The text describes the part for a person.
  int quantity = 0;
  std::string manufacturer;  ///< An empty name allows any manufacturer.
  /// The manufacturer's order number, which distributors use; boards have a number of our own.
  std::string part_number;
  std::string note;
};

/// Lists boards, chips, capacitors, controllers and cables of a design. `sides` and `islands` must belong to the same
/// design. Errors: none for a design that was read or made. Cost: O(n + patches · faces).
[[nodiscard]] std::vector<PartLine> parts_of(const design::Design& design, const sheet::Sides& sides,
                                             const std::vector<FlatIsland>& islands);

/// Returns the list as CSV (RFC 4180): part,quantity,manufacturer,part_number,note. Cost: linear.
[[nodiscard]] std::string parts_csv(const std::vector<PartLine>& parts);

}  // namespace triskin::fabrication

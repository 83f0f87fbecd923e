// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/geometry/table.hpp"

/// The tables of the solvers beside the names of the design (design_types.hpp).
namespace triskin::design_types {

using geometry::Table;
using geometry::Triple;
using Numbers = Table<int, int>;  ///< A list of nodes, or a number for each node, triangle or part.

}  // namespace triskin::design_types

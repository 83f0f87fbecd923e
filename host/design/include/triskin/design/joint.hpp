// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <span>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/layout/module.hpp"

namespace triskin::design {

/// Far end of a port: row in the list of the patch, −1 for none. Not a layout::JointEnd: a design that is checked or
/// simulated may have patches that no table can hold, and rows are computed with.
struct PortEnd {
  int row = -1;
  int port = 0;
  bool operator==(const PortEnd&) const = default;
};
using PortEnds = std::vector<std::array<PortEnd, layout::kPorts>>;

/// All joints between modules of one patch by row and port, also those that the tree leaves out; where the entry's
/// cable is plugged in there is none. `rotations` by row, as the modules are really turned; empty: as designed.
[[nodiscard]] PortEnds joints_of(const Design& design, int patch, std::span<const int> rotations = {});

}  // namespace triskin::design

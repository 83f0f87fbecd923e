// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <span>
#include <vector>

#include "triskin/design/design.hpp"

namespace triskin::design {

/// Far end of a port: row in the list of the patch, −1 for none.
struct PortEnd {
  int row = -1;
  int port = 0;
  bool operator==(const PortEnd&) const = default;
};
using PortEnds = std::vector<std::array<PortEnd, 3>>;

/// All joints between modules of one patch by row and port, also those that the tree leaves out; where the entry's
/// cable is plugged in there is none. `rotations` by row, as the modules are really turned; empty: as designed.
[[nodiscard]] PortEnds joints_of(const Design& design, int patch, std::span<const int> rotations = {});

}  // namespace triskin::design

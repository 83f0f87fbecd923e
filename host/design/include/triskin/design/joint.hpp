// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <span>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/layout/module.hpp"

namespace triskin::design {

/// Far end of a port. `row` is an index in Patch::modules (not a node and not a module id), −1 for none. Not a
/// layout::JointEnd: a design that is checked or simulated may have patches that no table can hold, and rows are
/// computed with.
struct PortEnd {
  int row = -1;
  int port = 0;
  bool operator==(const PortEnd&) const = default;
};
/// Far ends by row and port: ends[row][port], as many rows as the patch has modules.
using PortEnds = std::vector<std::array<PortEnd, layout::kPorts>>;

/// All joints between modules of one patch by row and port, also those that the tree leaves out; where the entry's
/// cable is plugged in there is none. `patch`: index in design.patches. `rotations` by row, 0 … 2, as the modules are
/// really turned; empty: as designed. Errors: std::out_of_range for a patch or module that the design lacks.
/// Cost: O(n²) of the patch.
[[nodiscard]] PortEnds joints_of(const Design& design, int patch, std::span<const int> rotations = {});

/// Far end of a port, by module id; −1 for none.
struct ModuleEnd {
  int module = -1;
  int port = 0;
  bool operator==(const ModuleEnd&) const = default;
};

/// All joints by module and port: those inside the patches, and those between modules of two patches that lie side by
/// side; none where the cable of an entry or second entry is plugged in. `rotations` by module, 0 … 2, as the modules
/// are really turned; empty: as designed. Errors: std::out_of_range for a module that the design lacks. Cost: O(n).
[[nodiscard]] std::vector<std::array<ModuleEnd, layout::kPorts>> module_ends(const Design& design,
                                                                             std::span<const int> rotations = {});

}  // namespace triskin::design

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <span>
#include <vector>

#include "triskin/base/format_index.hpp"
#include "triskin/design/design.hpp"
#include "triskin/layout/index.hpp"
#include "triskin/layout/module.hpp"

namespace triskin::design {

/// A port has a far end; a row of −1 means none. It differs from layout::JointEnd, because a design that is checked
/// or simulated may have patches that are too large for a table, and because code calculates with rows.
struct PortEnd {
  layout::TableRow row = layout::TableRow::none();
  int port = 0;
  bool operator==(const PortEnd&) const = default;
};
/// Far ends are indexed as ends[row][port], with as many rows as the patch has modules.
using PortEnds = std::vector<std::array<PortEnd, layout::kPorts>>;

/// Returns all joints between modules of one patch by row and port, including those outside the tree; the port with the
/// entry's cable has none. `rotations`: by row, 0 … 2, as the modules are really turned; empty means as designed.
/// Errors: std::out_of_range for a patch or module that the design lacks. Cost: O(n²) of the patch.
[[nodiscard]] PortEnds joints_of(const Design& design, layout::PatchIndex patch, std::span<const int> rotations = {});

/// The far end of a port is given by module id; −1 means that there is none.
struct ModuleEnd {
  layout::ModuleId module = layout::ModuleId::none();
  int port = 0;
  bool operator==(const ModuleEnd&) const = default;
};

/// Returns all joints by module and port: those inside patches, and those between adjacent modules of two patches;
/// ports with the cable of an entry or second entry have none. `rotations`: by module, 0 … 2, as the modules are
/// really turned; empty means as designed. Errors: std::out_of_range for a module that the design lacks. Cost: O(n).
[[nodiscard]] std::vector<std::array<ModuleEnd, layout::kPorts>> module_ends(const Design& design,
                                                                             std::span<const int> rotations = {});

}  // namespace triskin::design

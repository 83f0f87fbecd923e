// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <set>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/diagnose/finding_kind.hpp"

namespace triskin::diagnose {

/// Because of this break, modules of a switched patch are not found.
struct MissingCause {
  FindingKind kind = FindingKind::kMissingModule;      ///< The other possible kind is kMissingJoint.
  layout::ModuleId module = layout::ModuleId::none();  ///< It is dead, or the far end of the broken joint.
  layout::ModuleId other = layout::ModuleId::none();   ///< With kMissingJoint, this end of the joint was found.
  /// Only this break makes these modules unreachable (ascending); with a joint, `module` is one of them.
  std::vector<layout::ModuleId> behind;
};

/// Returns the fewest breaks that explain why the modules `missing` of patch `patch` were not found although every
/// joint was tried: every path from a found module to a missing one contains a break. A single joint in front of
/// several modules is a broken joint; a module with several such joints, or one that is alone, is dead. Modules in
/// `alive` answered by another way (a neighbour reads them), so they are not dead. Throws std::out_of_range for a patch
/// that the design lacks. Cost: O(n²) of the patch.
[[nodiscard]] std::vector<MissingCause> explain_missing(const design::Design& design, layout::PatchIndex patch,
                                                        const std::set<layout::ModuleId>& missing,
                                                        const std::set<layout::ModuleId>& alive);

}  // namespace triskin::diagnose

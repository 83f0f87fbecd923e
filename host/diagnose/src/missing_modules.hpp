// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <set>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/diagnose/finding_kind.hpp"

namespace triskin::device {

/// One break that keeps modules of a switched patch from being found.
struct MissingCause {
  FindingKind kind = FindingKind::kMissingModule;  ///< or kMissingJoint
  int module = -1;                                 ///< the dead module, or the far end of the broken joint
  int other = -1;                                  ///< kMissingJoint: its end that was found
  std::vector<int> behind;  ///< modules that only this keeps out of reach, ascending; with a joint also `module`
};

/// The fewest breaks that explain why the modules `missing` of patch `patch` were not found although every joint of the
/// patch was tried: on each way from a module that was found to a missing one something is broken. A single joint in
/// front of several modules is a broken joint; a module with several such joints, or one that stands alone, is dead.
/// `alive`: modules that answered by another way (a neighbour reads them), so they are not dead. Throws
/// std::out_of_range for a patch that the design lacks. Cost: O(n²) of the patch.
[[nodiscard]] std::vector<MissingCause> explain_missing(const design::Design& design, int patch,
                                                        const std::set<int>& missing, const std::set<int>& alive);

}  // namespace triskin::device

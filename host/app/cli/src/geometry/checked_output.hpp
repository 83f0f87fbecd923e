// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "triskin/base/progress.hpp"
#include "triskin/check/design_rules.hpp"
#include "triskin/design/design.hpp"

namespace triskin::cli {

/// What the independent checker found in a design that is to be written.
struct OutputCheck {
  check::DesignReport report;
  std::vector<std::string> removed;  ///< for each module that was taken away the rule that it broke
  double seconds = 0.0;
  /// False if a wish of the user is not met that may stand in a file: what must be covered is not, a cable enters
  /// elsewhere.
  [[nodiscard]] bool keeps_all_rules() const { return report.violations.empty(); }
};

enum class OnViolation {
  kRemoveModules,  ///< Takes modules away until no rule is broken and wires the rest anew, in `design` too.
  kRefuse,
};

/// Writes the design to `path` once `check` has nothing against its text. Errors: InputError naming rule, module and
/// numbers for what cannot be mended, and then nothing is written. Cost: that of `triskin check` (docs/check.md).
OutputCheck write_checked_design(const std::string& path, design::Design& design, OnViolation on_violation,
                                 const ProgressSink& progress = {});

}  // namespace triskin::cli

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/design/design_types.hpp"

namespace triskin::lattice {

/// A module that breaks a limit, and the name of the limit as in design files.
struct WorstModule {
  int module;
  const char* limit;
};

/// Returns modules with more than 98 % of a limit (so that another measurement agrees), joints included, except the
/// first `kept`: among those within 60 mm of one another only the worst. Farther ones do not change when these are
/// removed, so all of them can be removed at once with the same result as removing the worst again and again. If there
/// are none, returns those that pass through another in space ("pierced"), of two the later: overlap is measured in the
/// plane between them, and sheets that cross steeply, or face away from each other, have none. Cost: O(n + b²) with b
/// that break a limit; at the end the pairs of near modules besides.
[[nodiscard]] std::vector<WorstModule> worst_modules(const ModuleLayout& layout, const LayoutLimits& limits,
                                                     std::size_t kept = 0);

}  // namespace triskin::lattice

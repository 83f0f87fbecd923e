// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/design/design_types.hpp"

namespace triskin::geometry {

/// A module that breaks a limit, and the name of the limit as in design files.
struct WorstModule {
  int module;
  const char* limit;
};

/// Modules with more than 98 % of a limit (so that another measurement agrees), joints included, but for the first
/// `kept`: of those within 60 mm of one another the worst alone. What is farther does not change when they go, so that
/// all of them can go at once and the result is that of removing the worst again and again. When there are none, those
/// that pass through another in space ("pierced"), of two the later: overlap is measured in the plane between them, and
/// sheets that cross steeply, or face away from each other, have none. Cost: O(n + b²) with b that break a limit;
/// at the end the pairs of near modules besides.
[[nodiscard]] std::vector<WorstModule> worst_modules(const ModuleLayout& layout, const LayoutLimits& limits,
                                                     std::size_t kept = 0);

}  // namespace triskin::geometry

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <utility>
#include <vector>

#include "triskin/geometry/design_types.hpp"

namespace triskin::geometry {

/// How far over its limits a module is, joints aside, 1 = at the limit, and the name of the one that is broken most.
[[nodiscard]] std::pair<double, const char*> worst_limit(const PlacedModule& module, const LayoutLimits& limits);

/// Modules with more than 98 % of a limit (so that another measurement agrees), joints included, but for the first
/// `kept`: of those within 60 mm of one another the worst alone. What is farther does not change when they go, so that
/// all of them can go at once and the result is that of removing the worst again and again. Cost: O(n + b²) with b that
/// break a limit.
[[nodiscard]] std::vector<int> worst_modules(const ModuleLayout& layout, const LayoutLimits& limits,
                                             std::size_t kept = 0);

}  // namespace triskin::geometry

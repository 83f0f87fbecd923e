// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/geometry/design_types.hpp"

namespace triskin::geometry {

/// A module that breaks a limit.
struct BrokenModule {
  int module;
  double ratio;    ///< how far over the limit, 1 = at it
  Vec3 center_mm;  ///< of its corners
};

/// Those that are the worst among the ones within 60 mm: what is farther does not change when they go, so that all of
/// them can go at once and the result is that of removing the worst again and again. Cost: O(n²) in the broken ones.
[[nodiscard]] std::vector<int> worst_of_their_places(const std::vector<BrokenModule>& broken);

}  // namespace triskin::geometry

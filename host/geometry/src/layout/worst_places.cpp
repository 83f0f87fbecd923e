// SPDX-License-Identifier: GPL-3.0-or-later
#include "worst_places.hpp"

#include <algorithm>
#include <utility>

namespace triskin::geometry {

constexpr double kApart_mm = 60.0;  // of centres: modules that have no side, corner or overlap in common

std::vector<int> worst_of_their_places(const std::vector<BrokenModule>& broken) {
  std::vector<int> worst;
  for (const BrokenModule& b : broken) {
    if (std::ranges::none_of(broken, [&](const BrokenModule& o) {
          return std::pair(-o.ratio, o.module) < std::pair(-b.ratio, b.module) &&
                 (o.center_mm - b.center_mm).norm() < kApart_mm;
        }))
      worst.push_back(b.module);
  }
  return worst;
}

}  // namespace triskin::geometry

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/geometry/routing.hpp"
#include "triskin/geometry/surface.hpp"

namespace triskin::pipeline {

/// A layout with the controllers and jumpers that it needs.
struct WiredLayout {
  design::ModuleLayout layout;
  std::vector<design::Jumper> places;  ///< where jumpers may be
  int patches = 0, jumpers = 0;        ///< the cheapest found
  double price = 0.0;                  ///< of them and of the islands
  /// Modules − price; of no module less than anything, since a cover was asked for.
  [[nodiscard]] double value() const {
    return layout.modules.empty() ? -1e300 : static_cast<double>(layout.modules.size()) - price;
  }
};

/// Finds the places of jumpers and the cheapest controllers of each layout, and sorts by falling value; among equals
/// the order stays. Uses `threads` ≥ 1 threads; the result does not depend on their number.
[[nodiscard]] std::vector<WiredLayout> by_value(const geometry::Surface& surface,
                                                std::vector<design::ModuleLayout> layouts,
                                                const design::LayoutLimits& limits,
                                                const geometry::RoutingOptions& routing, int threads);

/// Those of which none has at least as many modules for a lower or equal price: most modules first.
[[nodiscard]] std::vector<design::Alternative> front_of(const std::vector<WiredLayout>& wired);

}  // namespace triskin::pipeline

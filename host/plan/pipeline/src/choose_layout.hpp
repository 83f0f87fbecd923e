// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/mesh/surface.hpp"
#include "triskin/mesh/surface_regions.hpp"
#include "triskin/routing/routing.hpp"

namespace triskin::pipeline {

/// A layout with the controllers and jumpers that it needs.
struct WiredLayout {
  design::ModuleLayout layout;
  std::vector<design::Jumper> places;  ///< Jumpers are possible at these places.
  /// Divides the modules among controllers, with jumpers at the places.
  std::shared_ptr<const routing::Division> division;
  int patches = 0, jumpers = 0;  ///< Both numbers belong to the cheapest solution found.
  double price = 0.0;            ///< The price sums patches, jumpers and islands.
  double module_value = 0.0;     ///< The value of the modules, or their number without regions.
  /// Returns worth − price. A layout without modules is worth less than any other, since a cover was asked for.
  [[nodiscard]] double value() const { return layout.modules.empty() ? -1e300 : module_value - price; }
};

/// Finds the places of jumpers and the cheapest controllers of a layout. `regions` of the surface may be null. Cost:
/// about 0.1 s for 150 modules, 2 s for 4,500.
[[nodiscard]] WiredLayout priced(const mesh::Surface& surface, design::ModuleLayout layout,
                                 const design::LayoutLimits& limits, const routing::RoutingOptions& routing,
                                 const mesh::SurfaceRegions* regions);

/// Does the same for each of several layouts. The first is always priced; others that are not begun when
/// routing.give_up() returns true are left out. Uses `threads` ≥ 1 threads; while it is not late the result does not
/// depend on their number.
[[nodiscard]] std::vector<WiredLayout> priced(const mesh::Surface& surface, std::vector<design::ModuleLayout> layouts,
                                              const design::LayoutLimits& limits,
                                              const routing::RoutingOptions& routing,
                                              const mesh::SurfaceRegions* regions, int threads);

/// Returns layouts that no other beats in both value and price, the highest value first.
[[nodiscard]] std::vector<design::Alternative> front_of(const std::vector<WiredLayout>& wired);

}  // namespace triskin::pipeline

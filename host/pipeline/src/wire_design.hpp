// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/design/design.hpp"
#include "triskin/geometry/routing.hpp"
#include "triskin/geometry/surface.hpp"
#include "triskin/host/progress.hpp"

namespace triskin::pipeline {

/// Seed and price of a design for the router.
[[nodiscard]] geometry::RoutingOptions routing_options(const design::Design& design);

/// Gives the layout of a design, whose modules are measured, controllers, jumpers (at some of `places`), report and id.
void wire(design::Design& design, const geometry::Surface& surface, const std::vector<design::Jumper>& places,
          const ProgressSink& progress);

}  // namespace triskin::pipeline

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <memory>
#include <vector>

#include "triskin/base/progress.hpp"
#include "triskin/design/design.hpp"
#include "triskin/design/module_graph.hpp"
#include "triskin/mesh/surface.hpp"
#include "triskin/mesh/surface_regions.hpp"
#include "triskin/routing/routing.hpp"

namespace triskin::pipeline {

/// Passes the seed and price of a design to the router.
[[nodiscard]] routing::RoutingOptions routing_options(const design::Design& design);

/// Returns the regions of a design on its surface, to which they refer; null without regions. Cost: linear in the
/// faces.
[[nodiscard]] std::unique_ptr<const mesh::SurfaceRegions> regions_of(const mesh::Surface& surface,
                                                                     const design::Design& design);

/// Returns the graph for the wiring: that of the layout, but with borders only at sides where `regions` lets a cable
/// enter; null sets no limit. Cost: one closest point for each free side if entries are limited.
[[nodiscard]] design::ModuleGraph wired_graph(const design::ModuleLayout& layout, const mesh::SurfaceRegions* regions);

/// Gives the layout of a design, whose modules are measured, controllers, jumpers (at some of `places`), report and id;
/// the alternative that is taken states what they cost. `regions` of the surface may be null; `division` is that of
/// this layout with these places, if it is known. `kept` is wiring that stays; null wires everything anew.
void wire(design::Design& design, const mesh::Surface& surface, const mesh::SurfaceRegions* regions,
          const std::vector<design::Jumper>& places, const ProgressSink& progress,
          const std::shared_ptr<const routing::Division>& division = nullptr,
          const routing::KeptWiring* kept = nullptr);

}  // namespace triskin::pipeline

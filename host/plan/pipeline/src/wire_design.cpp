// SPDX-License-Identifier: GPL-3.0-or-later
#include "wire_design.hpp"

#include <algorithm>
#include <cmath>

#include "triskin/design/module_side.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/lattice/grow_lattice.hpp"

namespace triskin::pipeline {
namespace {

void fill_report(design::Design& design, const mesh::Surface& surface) {
  design::Design::Report& r = design.report;
  r.area_cm2 = surface.area_mm2() / 100.0;
  const double cut_mm2 = design::module_area_mm2(design.layout.corner_cut_mm);
  // Tolerances may let the modules exceed what the area holds.
  r.upper_bound = std::max(static_cast<int>(design.layout.modules.size()),
                           static_cast<int>(std::floor(surface.area_mm2() / cut_mm2)));
  r.coverage = static_cast<double>(design.layout.modules.size()) * design::kModuleArea_mm2 / surface.area_mm2();
  r.coverage_cut = static_cast<double>(design.layout.modules.size()) * cut_mm2 / surface.area_mm2();
  for (const design::PlacedModule& m : design.layout.modules) {
    r.max_edge_error_mm = std::max(r.max_edge_error_mm, m.edge_error_mm);
    r.max_center_gap_mm = std::max(r.max_center_gap_mm, m.center_gap_mm);
    r.max_edge_lift_mm = std::max(r.max_edge_lift_mm, m.edge_lift_mm);
    r.max_edge_depth_mm = std::max(r.max_edge_depth_mm, m.edge_depth_mm);
    for (const double gap : m.hinge_gap_mm) r.max_hinge_gap_mm = std::max(r.max_hinge_gap_mm, gap);
  }
}

// The wiring searches longer than the pricing did, so the taken alternative states the cost of the actual wiring.
void state_taken(design::Design& design) {
  if (design.taken < 0) return;
  design::Alternative& taken = design.alternatives[static_cast<std::size_t>(design.taken)];
  taken.patches = static_cast<int>(design::patches_of(design).size());
  taken.jumpers = static_cast<int>(design.layout.jumpers.size());
  taken.price = design.price.of(taken.patches, taken.jumpers, design.layout.islands);
}

void report_entries(design::Design& design, const mesh::SurfaceRegions& regions) {
  for (const layout::PatchIndex p : design::patches_of(design)) {
    const design::Patch& patch = design.patches[static_cast<std::size_t>(p)];
    const design::PlacedModule& entry = design.layout.modules[static_cast<std::size_t>(patch.entry)];
    if (!regions.allows_entry(design::middle_of_side(entry, patch.modules.front().rotation)))
      design.report.entries_elsewhere.push_back(p);
  }
}

void report_regions(design::Design& design, const mesh::Surface& surface, const mesh::SurfaceRegions* regions) {
  design.report.module_value = static_cast<double>(design.layout.modules.size());
  if (regions == nullptr) return;
  design.report.module_value = regions->weight_of(design.layout);
  design.report.uncovered = regions->uncovered(design.layout);
  report_entries(design, *regions);
  lattice::SurfaceLatticeOptions lattice;
  lattice.corner_cut_mm = design.layout.corner_cut_mm;
  lattice.regions = regions;
  for (design::Uncovered& u : design.report.uncovered) {
    const auto region = std::ranges::find(design.regions.list, u.region, &design::Region::name);
    u.why = lattice::why_uncovered(surface, design.limits, lattice, u.place_mm, region->within_mm);
  }
}

}  // namespace

std::unique_ptr<const mesh::SurfaceRegions> regions_of(const mesh::Surface& surface, const design::Design& design) {
  if (design.regions.empty()) return nullptr;
  return std::make_unique<const mesh::SurfaceRegions>(surface, design.regions);
}

design::ModuleGraph wired_graph(const design::ModuleLayout& layout, const mesh::SurfaceRegions* regions) {
  design::ModuleGraph graph = design::graph_of(layout);
  if (regions == nullptr || !regions->regions().limits_entries()) return graph;
  for (std::size_t k = 0; k < graph.nodes.size(); ++k) {
    for (std::size_t s = 0; s < 3; ++s) {
      bool& border = graph.nodes[k].border[s];
      border = border && regions->allows_entry(design::middle_of_side(layout.modules[k], static_cast<int>(s)));
    }
  }
  return graph;
}

routing::RoutingOptions routing_options(const design::Design& design) {
  routing::RoutingOptions routing;
  routing.second_entry_at_seam = !design.regions.limits_entries();
  routing.seed = design.seed;
  routing.price = design.price;
  return routing;
}

void wire(design::Design& design, const mesh::Surface& surface, const mesh::SurfaceRegions* regions,
          const std::vector<design::Jumper>& places, const ProgressSink& progress,
          const std::shared_ptr<const routing::Division>& division, const routing::KeptWiring* kept) {
  routing::RoutingOptions routing = routing_options(design);
  routing.division = division;
  // The router may turn these places into joints; none of them is in the layout yet.
  design.layout.jumpers.clear();
  const design::ModuleGraph graph = wired_graph(design.layout, regions);
  routing::RoutingResult routes = kept == nullptr ? routing::route(graph, places, routing, progress)
                                                  : routing::route_around(graph, places, *kept, routing, progress);
  design.layout.jumpers = std::move(routes.jumpers);
  design.patches = std::move(routes.patches);
  state_taken(design);
  design.report = {};
  fill_report(design, surface);
  report_regions(design, surface, regions);
  design.report.patches_lower_bound = routes.lower_bound;
  design.report.jumpers_lower_bound = routes.jumpers_lower_bound;
  design.design_id = design::design_id_of(design);
}

}  // namespace triskin::pipeline

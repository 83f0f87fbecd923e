// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/pipeline/make_design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "triskin/design/module_list.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/geometry/bend_seams.hpp"
#include "triskin/geometry/extract.hpp"
#include "triskin/geometry/map_modules.hpp"
#include "triskin/geometry/polygon_io.hpp"
#include "triskin/geometry/routing.hpp"
#include "triskin/geometry/surface.hpp"
#include "triskin/geometry/surface_lattice.hpp"

namespace triskin::pipeline {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kPiecesShare = 0.12;                      // of the time; what the growth has left after it
constexpr double kPieceLeast_s = 0.1;                      // a piece gets, or what a short limit has for it
constexpr double kGrowthShare = 0.5, kShortLimit_s = 3.0;  // up to which the limit binds
constexpr double kRoutingShare = 0.1, kRoutingMost_s = 0.8;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Large pieces first; each may use what its share of the area leaves of the time.
std::vector<geometry::TiledPiece> place_pieces(design::Design& design, const geometry::Net& net,
                                               const DesignOptions& options, Clock::time_point start,
                                               const ProgressSink& progress) {
  std::vector<geometry::TiledPiece> placed;
  double area_left = 0.0;
  for (const auto& piece : net.pieces) area_left += geometry::polygon_area(piece.outline);
  for (const design::Piece& piece : net.pieces) {
    const double area = geometry::polygon_area(piece.outline);
    geometry::PlacementOptions p;
    p.seed = options.seed;
    p.corner_cut_mm = options.corner_cut_mm;
    p.time_limit_s =
        std::max(std::min(kPieceLeast_s, 0.005 * options.time_limit_s),
                 0.7 * (kPiecesShare * options.time_limit_s - seconds_since(start)) * area / std::max(area_left, 1.0));
    area_left -= area;
    geometry::PlacementResult result;
    result.proved = true;  // a piece smaller than a module holds none
    if (area >= design::module_area_mm2(options.corner_cut_mm)) result = geometry::place(piece.outline, p);
    report(progress, "placing", -1.0,
           fmt::format("{} modules on piece {} of {}", result.modules, design.pieces.size() + 1, net.pieces.size()));
    design.pieces.push_back({piece, result.placement, result.modules, result.upper_bound, result.proved});
    placed.push_back({&piece, result.placement, std::move(result.tiles)});
  }
  return placed;
}

void fill_report(design::Design& design, const geometry::Surface& surface) {
  design::Design::Report& r = design.report;
  r.area_cm2 = surface.area_mm2() / 100.0;
  const double cut_mm2 = design::module_area_mm2(design.layout.corner_cut_mm);
  r.upper_bound = static_cast<int>(std::floor(surface.area_mm2() / cut_mm2));
  r.coverage = static_cast<double>(design.layout.modules.size()) * design::kModuleArea_mm2 / surface.area_mm2();
  r.coverage_cut = static_cast<double>(design.layout.modules.size()) * cut_mm2 / surface.area_mm2();
  for (const design::PlacedModule& m : design.layout.modules) {
    r.max_edge_error_mm = std::max(r.max_edge_error_mm, m.edge_error_mm);
    r.max_center_gap_mm = std::max(r.max_center_gap_mm, m.center_gap_mm);
    for (const double gap : m.hinge_gap_mm) r.max_hinge_gap_mm = std::max(r.max_hinge_gap_mm, gap);
  }
}

}  // namespace

design::Design make_design(const std::filesystem::path& mesh, const DesignOptions& options,
                           const ProgressSink& progress, MethodComparison* comparison) {
  const auto start = Clock::now();
  design::Design design;
  design.name = mesh.stem().string();
  design.source_file = mesh.filename().string();
  design.seed = options.seed;
  design.limits = options.limits;
  const geometry::MeshFile file = geometry::read_mesh(mesh, options.unit);
  design.scale_to_mm = file.report.scale_to_mm;
  geometry::require_manifold(file.mesh, mesh.string());
  design.surface = geometry::extract(file.mesh, progress).surface;
  geometry::require_no_self_intersection(design.surface, mesh.string());
  const geometry::Surface surface(design.surface);
  geometry::UnfoldingOptions unfolding;
  unfolding.edge_error_mm = options.limits.edge_error_mm;
  if (options.bend_radius_mm > 0.0) unfolding.seams = geometry::seams_along_bends(surface, options.bend_radius_mm);
  const geometry::Net net = geometry::unfold(surface, unfolding, progress);
  const auto placed = place_pieces(design, net, options, start, progress);
  report(progress, "mapping to the surface", -1.0);
  design.layout = geometry::map_modules(surface, placed, options.limits, options.corner_cut_mm);
  geometry::SurfaceLatticeOptions lattice;
  lattice.seed = options.seed;
  lattice.iterations = options.iterations;
  lattice.corner_cut_mm = options.corner_cut_mm;
  lattice.threads = options.threads;
  lattice.island_cost = options.island_cost;
  lattice.controller_cost = options.controller_cost;
  const double routing_s = std::min(kRoutingShare * options.time_limit_s, kRoutingMost_s);
  // The pieces of a fine mesh may take longer than the whole limit on a busy machine: the growth keeps its share all
  // the same.
  lattice.time_limit_s = std::max({0.1, kGrowthShare * (options.time_limit_s - kShortLimit_s),
                                   options.time_limit_s - routing_s - seconds_since(start)});
  design::ModuleLayout grown = geometry::grow_lattice(surface, options.limits, lattice, progress);
  if (comparison != nullptr)
    *comparison = {static_cast<int>(design.layout.modules.size()), static_cast<int>(grown.modules.size())};
  if (geometry::layout_value(grown, lattice) > geometry::layout_value(design.layout, lattice))
    design.layout = std::move(grown);
  geometry::RoutingOptions routing;
  routing.seed = options.seed;
  geometry::RoutingResult routes = geometry::route(design::graph_of(design.layout), routing, progress);
  design.patches = std::move(routes.patches);
  fill_report(design, surface);
  design.report.patches_lower_bound = routes.lower_bound;
  design.design_id = design::design_id_of(design);
  design.report.seconds = seconds_since(start);
  return design;
}

}  // namespace triskin::pipeline

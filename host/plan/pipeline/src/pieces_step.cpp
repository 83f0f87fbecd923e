// SPDX-License-Identifier: GPL-3.0-or-later
#include "pieces_step.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "triskin/design/outline.hpp"
#include "triskin/lattice/map_modules.hpp"
#include "triskin/placement/lattices.hpp"
#include "triskin/placement/placement.hpp"
#include "triskin/placement/polygon_io.hpp"
#include "triskin/unfolding/bend_seams.hpp"
#include "triskin/unfolding/developability.hpp"
#include "triskin/unfolding/unfolding.hpp"
#include "wire_design.hpp"

namespace triskin::pipeline {
namespace {

// Pieces won on plates, and on caps of spheres up to 0.0003 rad under a module; from 0.0008 rad on the growth had more
// modules (docs/measurements/unfolding.md). The limit leaves room for the tessellation of developable faces.
constexpr double kMaxCurvature_rad = 0.002;
// Unfolding ends after the first share of this step's time, placing after the second, and the search for several
// lattices after the third.
constexpr double kUnfoldingEnd = 0.4, kPlacingEnd = 0.6, kLatticesEnd = 0.8;
// Each piece gets at least this time, or this share of a short limit.
constexpr double kMinPiece_s = 0.1, kMinPieceShare = 0.005;

unfolding::Net pieces_of(const DesignInWork& work, const mesh::Surface& surface, double end_s) {
  unfolding::UnfoldingOptions unfolding;
  unfolding.edge_error_mm = work.options.limits.edge_error_mm;
  if (work.options.bend_radius_mm > 0.0)
    unfolding.seams = unfolding::seams_along_bends(surface, work.options.bend_radius_mm);
  unfolding.give_up = work.deadline(end_s);
  return unfolding::unfold(surface, unfolding, work.progress);
}

placement::PlacementResult placed_on(const DesignInWork& work, const design::Piece& piece, double area_mm2,
                                     double time_limit_s) {
  placement::PlacementOptions options;
  options.seed = work.options.seed;
  options.corner_cut_mm = work.options.corner_cut_mm;
  options.time_limit_s = std::max(std::min(kMinPiece_s, kMinPieceShare * work.options.time_limit_s), time_limit_s);
  if (area_mm2 >= design::module_area_mm2(options.corner_cut_mm)) return placement::place(piece.outline, options);
  placement::PlacementResult nothing;
  nothing.proved = true;  // A piece smaller than a module holds none.
  return nothing;
}

// Large pieces come first; each may use its share of the remaining time by area. Pieces that are not reached are left
// out: thousands of pieces of a triangle soup take longer than their shares.
std::vector<lattice::TiledPiece> place_pieces(DesignInWork& work, const unfolding::Net& net, double end_s) {
  std::vector<lattice::TiledPiece> placed;
  double area_left_mm2 = 0.0;
  for (const auto& piece : net.pieces) area_left_mm2 += placement::polygon_area(piece.outline);
  const auto is_late = work.deadline(end_s);
  for (const design::Piece& piece : net.pieces) {
    if (!placed.empty() && is_late && is_late()) break;
    const double area_mm2 = placement::polygon_area(piece.outline);
    const double share = area_mm2 / std::max(area_left_mm2, 1.0);
    placement::PlacementResult result = placed_on(work, piece, area_mm2, share * (end_s - work.budget.used_s()));
    area_left_mm2 -= area_mm2;
    report(work.progress, "placing", -1.0,
           fmt::format("{} modules on piece {} of {}", result.modules, placed.size() + 1, net.pieces.size()));
    work.design.pieces.push_back({piece, result.placement, result.modules, result.upper_bound, result.proved});
    placed.push_back({&piece, result.placement, std::move(result.tiles)});
  }
  work.notes.pieces_left_out = static_cast<int>(net.pieces.size() - placed.size());
  return placed;
}

// Several lattices on each piece, which begin with its best single one. Pieces share the time by area.
std::vector<lattice::TiledPiece> place_several(const DesignInWork& work, const std::vector<lattice::TiledPiece>& single,
                                               double end_s) {
  std::vector<lattice::TiledPiece> placed;
  double area_left_mm2 = 0.0;
  for (const lattice::TiledPiece& on : single) area_left_mm2 += placement::polygon_area(on.piece->outline);
  for (const lattice::TiledPiece& on : single) {
    const double area_mm2 = placement::polygon_area(on.piece->outline);
    placement::LatticesOptions options;
    options.seed = work.options.seed;
    options.steps = work.options.iterations;
    const double until_s = work.options.iterations > 0 ? work.options.time_limit_s : end_s;
    options.time_limit_s = std::max(0.01, area_mm2 / std::max(area_left_mm2, 1.0) * (until_s - work.budget.used_s()));
    area_left_mm2 -= area_mm2;
    if (area_mm2 < design::kModuleArea_mm2) continue;
    placement::FlatLayout layout =
        placement::place_lattices(on.piece->outline, {on.placement, on.tiles}, options, work.progress);
    for (placement::FlatLattice& l : layout.lattices) placed.push_back({on.piece, l.placement, std::move(l.tiles)});
  }
  return placed;
}

// The modules of the pieces keep the limits on the original.
design::ModuleLayout mapped_layout(const DesignInWork& work, const SearchedSurface& searched,
                                   const std::vector<lattice::TiledPiece>& placed, const mesh::SurfaceRegions* regions,
                                   double end_s) {
  const design::LayoutLimits& limits = work.options.limits;
  const mesh::DecimatedMesh* const solver = searched.solver();
  design::ModuleLayout layout =
      lattice::map_modules(searched.surface(), placed, solver == nullptr ? limits : mesh::limits_on(*solver, limits),
                           work.options.corner_cut_mm, regions, work.deadline(end_s));
  if (solver != nullptr) lattice::keep_limits(searched.original(), limits, layout, regions);
  return layout;
}

}  // namespace

bool are_pieces_tried(DesignInWork& work, const mesh::Surface& surface) {
  work.notes.curvature_rad =
      unfolding::total_curvature_rad(surface) * design::kModuleArea_mm2 / std::max(surface.area_mm2(), 1.0);
  if (work.options.method != SearchMethod::kAuto) return work.options.method == SearchMethod::kPieces;
  return work.notes.curvature_rad <= kMaxCurvature_rad;
}

std::vector<WiredLayout> layouts_on_pieces(DesignInWork& work, const SearchedSurface& searched,
                                           const mesh::SurfaceRegions* regions, double end_s) {
  const double begin_s = work.budget.used_s();
  const auto at_share = [&](double share) { return begin_s + share * (end_s - begin_s); };
  const unfolding::Net net = pieces_of(work, searched.surface(), at_share(kUnfoldingEnd));
  routing::RoutingOptions routing = routing_options(work.design);
  routing.threads = work.options.threads;
  routing.give_up = work.deadline(end_s);
  std::vector<WiredLayout> layouts;
  const auto add = [&](const std::vector<lattice::TiledPiece>& placed) {
    report(work.progress, "mapping to the surface", -1.0);
    design::ModuleLayout mapped = mapped_layout(work, searched, placed, regions, end_s);
    work.notes.pieces = std::max(work.notes.pieces, static_cast<int>(mapped.modules.size()));
    layouts.push_back(priced(searched.original(), std::move(mapped), work.options.limits, routing, regions));
  };
  const std::vector<lattice::TiledPiece> single = place_pieces(work, net, at_share(kPlacingEnd));
  add(single);
  if (work.options.method == SearchMethod::kPieces && work.options.corner_cut_mm == 0.0)
    add(place_several(work, single, at_share(kLatticesEnd)));
  // The pieces name faces of the solver's mesh, which the design does not contain.
  if (searched.solver() != nullptr) work.design.pieces.clear();
  return layouts;
}

}  // namespace triskin::pipeline

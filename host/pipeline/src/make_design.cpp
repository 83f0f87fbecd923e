// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/pipeline/make_design.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <utility>

#include "choose_layout.hpp"
#include "resolve_regions.hpp"
#include "seconds_since.hpp"
#include "triskin/base/error.hpp"
#include "triskin/design/outline.hpp"
#include "triskin/lattice/grow_lattice.hpp"
#include "triskin/lattice/map_modules.hpp"
#include "triskin/mesh/decimated_mesh.hpp"
#include "triskin/mesh/extract.hpp"
#include "triskin/mesh/open_side.hpp"
#include "triskin/mesh/surface.hpp"
#include "triskin/placement/placement.hpp"
#include "triskin/placement/polygon_io.hpp"
#include "triskin/routing/jumpers.hpp"
#include "triskin/routing/routing.hpp"
#include "triskin/unfolding/bend_seams.hpp"
#include "triskin/unfolding/unfolding.hpp"
#include "wire_design.hpp"

namespace triskin::pipeline {
namespace {

constexpr double kRepairShare = 0.4;  // Repair gets this share of the time.
// With a short limit, repair gets this time, or this share of the limit.
constexpr double kShortRepair_s = 2.0, kShortRepairShare = 0.7;
constexpr double kUnfoldingShare = 0.3;  // Unfolding gets this share of what reading and repair leave.
// Above this many faces per second of the limit the share shrinks, since most such meshes are given up.
constexpr double kUnfoldedFaces = 10'000.0;
constexpr double kMaxUnfolded = 2.0;   // Above this multiple the first step alone would take longer.
constexpr double kPiecesShare = 0.12;  // Pieces get this share of the time; the growth gets what is left after them.
constexpr double kPieceLeast_s = 0.1;  // Each piece gets at least this time, or what a short limit allows.
constexpr double kMapped_s = 2.5e-4;   // Measured time to map a module on a piece, with the steps that follow.
// Work that has not started by this share of the time is left out.
constexpr double kPlacingEnd = 0.65, kMappingEnd = 0.85;
// The growth gets half of the time; a limit up to 3 s is binding for it.
constexpr double kGrowthShare = 0.5, kShortLimit_s = 3.0;
// To give the growth its share, the limit may be exceeded by 12 %.
constexpr double kMaxOver = 0.12, kMinGrowth_s = 0.1;
// The growth gets all of its share if the pieces leave this much of the surface uncovered.
constexpr double kWorthGrowing = 0.1;
constexpr double kRoutingShare = 0.1, kRoutingMost_s = 2.0;
// Routing the layouts of a growth takes about 3 ms per module that the area has room for (measured); we reserve twice
// that.
constexpr double kRoutingLeast_s = 0.3, kRouting_s = 6.5e-3;
// We assume that the growth finds at most this many times the modules of the pieces.
constexpr double kMaxGrowth = 3.0;
// Measuring and wiring the grown layout (with its failures) each take this multiple of the time that mapping and
// pricing take for as many modules on pieces.
constexpr double kMeasuringShare = 0.25, kWiringShare = 0.25;
constexpr double kWritingShare = 0.8;  // Writing the surface takes 80 % of the time that reading took (measured).
constexpr double kWriting_s = 5e-5;    // Measured time to write a module with its alternatives, 4 kB each.
constexpr double kPricing_s = 1.2e-4;  // Measured time to map and price a module, used if no piece was timed.

// With a fixed number of steps the repair's clock stands still: its result must not depend on the time.
geometry::Extraction surface_of(const geometry::Mesh& mesh, const std::string& name, const DesignOptions& options,
                                Clock::time_point start, const ProgressSink& progress) {
  if (options.repair == RepairMode::kNever) {
    geometry::require_manifold(mesh, name);
    geometry::Extraction e = geometry::extract(mesh, progress);
    geometry::require_no_self_intersection(e.surface, name);
    return e;
  }
  geometry::ExtractOptions steps;
  steps.repair = steps.keep_usable = true;
  steps.outer = steps.wrap = geometry::ExtractOptions::When::kWhenNeeded;
  const double limit_s = options.time_limit_s;
  steps.repair_s = std::max(kRepairShare * limit_s, std::min(kShortRepair_s, kShortRepairShare * limit_s));
  steps.clock_s = [start, stands = options.iterations > 0] { return stands ? 0.0 : seconds_since(start); };
  return geometry::extract(mesh, steps, progress);
}

// The side that is covered, with its holes bridged; what it was taken from goes into the design, for the checker. False
// where both sides look alike: the caller asks, and nothing is covered.
bool take_surface(geometry::Extraction& extraction, const DesignOptions& options, design::Design& design,
                  DesignNotes* notes) {
  geometry::TakenSide taken = geometry::take_side(extraction.surface, options.side);
  if (taken.is_undecided) {
    if (notes == nullptr)
      throw InputError("both sides of the part's wall look alike; say which one is wanted (DesignOptions::side)");
    notes->side = std::move(taken);
    notes->part = std::move(extraction.surface);
    return false;
  }
  const geometry::Mesh part = std::exchange(extraction.surface, std::exchange(taken.surface, {}));
  if (options.bridge_mm > 0.0) {
    const geometry::BridgeReport bridges = geometry::bridge_holes(extraction.surface, part, options.bridge_mm);
    if (notes != nullptr) notes->bridges = bridges;
  }
  if (taken.choice.has_wall) {
    const bool both = options.side.wanted == geometry::SideWanted::kBoth;
    design.side = design::PartSide{geometry::side_name(taken), taken.choice.is_certain, taken.choice.wall_mm,
                                   both ? geometry::Mesh{} : part};
  }
  design.surface = extraction.surface;
  if (notes != nullptr) notes->side = std::move(taken);
  return true;
}

double area_of(const geometry::Mesh& mesh) {
  double twice = 0.0;
  for (const auto& f : mesh.faces) {
    const auto corner = [&](std::size_t k) -> const geometry::Vec3& {
      return mesh.vertices[static_cast<std::size_t>(f[k])];
    };
    twice += (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
  }
  return 0.5 * twice;
}

// The pieces give up when their share of the time is over, so that the growth has its own.
geometry::Net pieces_of(const geometry::Surface& surface, const DesignOptions& options, Clock::time_point start,
                        const ProgressSink& progress) {
  const double faces = static_cast<double>(surface.mesh().faces.size());
  const double max_faces = kUnfoldedFaces * options.time_limit_s;
  if (options.iterations == 0 && faces > kMaxUnfolded * max_faces) return {};
  geometry::UnfoldingOptions unfolding;
  unfolding.edge_error_mm = options.limits.edge_error_mm;
  if (options.bend_radius_mm > 0.0) unfolding.seams = geometry::seams_along_bends(surface, options.bend_radius_mm);
  const double share = kUnfoldingShare * std::min(1.0, max_faces / std::max(faces, 1.0));
  const double end_s = seconds_since(start) + share * std::max(0.0, options.time_limit_s - seconds_since(start));
  unfolding.give_up = give_up_at(start, end_s, options.iterations);
  return geometry::unfold(surface, unfolding, progress);
}

// Large pieces first; each may use what its share of the area leaves of the time. Those that it does not reach are left
// out: of a soup thousands of pieces take longer than their shares.
std::vector<geometry::TiledPiece> place_pieces(design::Design& design, const geometry::Net& net,
                                               const DesignOptions& options, Clock::time_point start,
                                               const ProgressSink& progress) {
  std::vector<geometry::TiledPiece> placed;
  double area_left = 0.0;
  for (const auto& piece : net.pieces) area_left += geometry::polygon_area(piece.outline);
  std::size_t modules = 0;
  for (const design::Piece& piece : net.pieces) {
    const double end_s =
        std::min(kPlacingEnd * options.time_limit_s, options.time_limit_s - kMapped_s * static_cast<double>(modules));
    if (!placed.empty() && options.iterations == 0 && seconds_since(start) > end_s) break;
    const double area = geometry::polygon_area(piece.outline);
    geometry::PlacementOptions p;
    p.seed = options.seed;
    p.corner_cut_mm = options.corner_cut_mm;
    p.time_limit_s =
        std::max(std::min(kPieceLeast_s, 0.005 * options.time_limit_s),
                 0.7 * (kPiecesShare * options.time_limit_s - seconds_since(start)) * area / std::max(area_left, 1.0));
    area_left -= area;
    geometry::PlacementResult result;
    result.proved = true;  // A piece smaller than a module holds none.
    if (area >= design::module_area_mm2(options.corner_cut_mm)) result = geometry::place(piece.outline, p);
    report(progress, "placing", -1.0,
           fmt::format("{} modules on piece {} of {}", result.modules, design.pieces.size() + 1, net.pieces.size()));
    modules += result.tiles.size();
    design.pieces.push_back({piece, result.placement, result.modules, result.upper_bound, result.proved});
    placed.push_back({&piece, result.placement, std::move(result.tiles)});
  }
  return placed;
}

void require_places(const design::KindPlan& plan) {
  if (std::ranges::all_of(plan.regions, [](const auto& r) { return design::is_place(r.region); })) return;
  throw InputError(
      "kinds: a region names modules or an island, which have numbers only when the design is there; make it without "
      "--kinds, then run triskin edit DESIGN --kinds");
}

// Results of the pieces, from which the time of the growth and of later steps is estimated.
struct PiecesDone {
  double at_most;               // Upper bound of the modules, by area.
  double uncovered;             // Share of the surface, 0 … 1.
  double mapping_s, pricing_s;  // Estimated for a layout of the growth, from the layout of the pieces.
  double writing_s;             // Time to write the design file.

  [[nodiscard]] double wiring_s() const { return kWiringShare * (mapping_s + pricing_s) + writing_s; }
  [[nodiscard]] double after_growth_s(double limit_s) const {
    const double routing_s =
        std::min({kRoutingShare * limit_s, kRoutingMost_s, kRoutingLeast_s + kRouting_s * at_most});
    return kMeasuringShare * (mapping_s + pricing_s) + wiring_s() + std::max(routing_s, pricing_s);
  }
};

PiecesDone pieces_done(const geometry::Surface& surface, std::size_t modules, double mapping_s, double pricing_s,
                       double reading_s) {
  const double covered_mm2 = static_cast<double>(modules) * design::kModuleArea_mm2;
  const double at_most = surface.area_mm2() / design::kModuleArea_mm2;
  const double writing_s = kWritingShare * reading_s;
  if (modules == 0) return {at_most, 1.0, 0.0, kPricing_s * at_most, writing_s + kWriting_s * at_most};
  const double more = std::clamp(at_most / static_cast<double>(modules), 1.0, kMaxGrowth);
  return {at_most, std::max(0.0, 1.0 - covered_mm2 / surface.area_mm2()), more * mapping_s, more * pricing_s,
          writing_s + more * kWriting_s * static_cast<double>(modules)};
}

// What pieces and growth are searched on: the surface, or a mesh with fewer faces.
class SearchedSurface {
 public:
  SearchedSurface(const geometry::Surface& original, const DesignOptions& options)
      : original_(original),
        solver_(geometry::solver_mesh_of(original, options.limits, options.solver_deviation_mm, options.threads)) {
    if (solver_) reduced_.emplace(solver_->mesh);
  }

  [[nodiscard]] const geometry::Surface& surface() const { return reduced_ ? *reduced_ : original_; }
  [[nodiscard]] const geometry::DecimatedMesh* solver() const { return solver_ ? &*solver_ : nullptr; }

 private:
  const geometry::Surface& original_;
  std::optional<geometry::DecimatedMesh> solver_;
  std::optional<geometry::Surface> reduced_;
};

// The modules of the pieces keep the limits on the original.
design::ModuleLayout mapped_layout(const geometry::Surface& original, const SearchedSurface& searched,
                                   const std::vector<geometry::TiledPiece>& placed, const DesignOptions& options,
                                   const geometry::SurfaceRegions* regions, Clock::time_point start) {
  const geometry::DecimatedMesh* const solver = searched.solver();
  design::ModuleLayout layout = geometry::map_modules(
      searched.surface(), placed, solver == nullptr ? options.limits : geometry::limits_on(*solver, options.limits),
      options.corner_cut_mm, regions, give_up_at(start, kMappingEnd * options.time_limit_s, options.iterations));
  if (solver != nullptr) geometry::keep_limits(original, options.limits, layout, regions);
  return layout;
}

// The layouts grown on the surface, best first. The pieces of a fine mesh may take longer than the whole limit on a
// busy machine: the growth keeps its share all the same, but for pieces that leave it next to nothing to gain. It is
// left out, none returned, where the time is over, what may be passed included, and the pieces have a layout.
std::vector<design::ModuleLayout> grow(const geometry::Surface& surface, const geometry::DecimatedMesh* solver,
                                       const DesignOptions& options, const geometry::SurfaceRegions* regions,
                                       Clock::time_point start, const PiecesDone& pieces,
                                       const ProgressSink& progress) {
  geometry::SurfaceLatticeOptions lattice;
  lattice.seed = options.seed;
  lattice.iterations = options.iterations;
  lattice.corner_cut_mm = options.corner_cut_mm;
  lattice.threads = options.threads;
  lattice.price = options.price;
  lattice.regions = regions;
  lattice.solver = solver;
  lattice.front = options.iterations > 0 || options.time_limit_s > kShortLimit_s;
  const double share = kGrowthShare * std::min(1.0, pieces.uncovered / kWorthGrowing);
  const double left_s = options.time_limit_s - pieces.after_growth_s(options.time_limit_s) - seconds_since(start);
  const double max_s = left_s + kMaxOver * options.time_limit_s;
  if (options.iterations == 0 && max_s < 0.0 && pieces.uncovered < 1.0) {
    report(progress, "leaving out the growth on the surface", -1.0, "no time is left");
    return {};
  }
  lattice.time_limit_s =
      std::max({kMinGrowth_s, left_s, std::min(max_s, share * (options.time_limit_s - kShortLimit_s))});
  return geometry::grow_front(surface, options.limits, lattice, progress);
}

std::optional<design::Design::PartSource> part_source(const geometry::MeshReadReport& report,
                                                      const cad::FaceSelection& faces) {
  if (!report.part) return std::nullopt;
  return design::Design::PartSource{report.part->faces, report.part->face_count, report.part->deviation_mm,
                                    cad::selection_text(faces)};
}

// Limits of the lattice for a bending radius: a side of a module is a chord, whose sagitta is a²/(8R)
// (docs/bending.md).
DesignOptions with_bend_limits(DesignOptions options) {
  if (options.bend_radius_mm <= 0.0) return options;
  const double sagitta_mm = design::kSide_mm * design::kSide_mm / (8.0 * options.bend_radius_mm);
  options.limits.depth_mm = std::min(options.limits.depth_mm, sagitta_mm);
  options.limits.lift_mm = std::min(options.limits.lift_mm, sagitta_mm);
  return options;
}

// Faces that were asked for, or those that an older version of the part was covered on.
cad::FaceSelection faces_of(const DesignOptions& options) {
  const bool is_asked = cad::selection_text(options.faces) != cad::selection_text({});
  if (is_asked || options.like == nullptr || !options.like->part) return options.faces;
  return cad::parse_selection(options.like->part->selection);
}

design::Design revised(design::Design part, const DesignOptions& options, Clock::time_point start,
                       const ProgressSink& progress, DesignNotes* notes) {
  Revision revision;
  const GrowAroundOptions effort{std::max(kMinGrowth_s, options.time_limit_s - seconds_since(start)),
                                 options.iterations, options.threads};
  design::Design design = revise_design(*options.like, std::move(part), effort, revision, progress);
  design.report.seconds = seconds_since(start);
  if (notes != nullptr) notes->revision = std::move(revision);
  return design;
}

}  // namespace

design::Design make_design(const std::filesystem::path& mesh, const DesignOptions& given, const ProgressSink& progress,
                           DesignNotes* notes) {
  const auto start = Clock::now();
  const DesignOptions options = with_bend_limits(given);
  design::Design design;
  design.name = mesh.stem().string();
  design.source_file = mesh.filename().string();
  design.seed = options.seed;
  design.limits = options.limits;
  design.price = options.price;
  design.kinds = options.kinds;
  require_places(options.kinds);
  const cad::FaceSelection faces = faces_of(options);
  const geometry::MeshFile file = geometry::read_mesh(mesh, options.unit, options.object, faces);
  design.part = part_source(file.report, faces);
  if (notes != nullptr) notes->read = file.report;
  const double reading_s = seconds_since(start);
  design.scale_to_mm = file.report.scale_to_mm;
  if (notes != nullptr) notes->reading = file.report.notes;
  // Smaller than a module: nothing fits, whatever its faces do, and that is an answer.
  if (const double area_mm2 = area_of(file.mesh); area_mm2 < design::kModuleArea_mm2) {
    design.surface = file.mesh;
    design.report.area_cm2 = area_mm2 / 100.0;
    design.report.seconds = seconds_since(start);
    return design;
  }
  geometry::Extraction extraction = surface_of(file.mesh, mesh.string(), options, start, progress);
  if (options.flip) geometry::turn_over(extraction.surface);
  if (notes != nullptr) notes->extract = extraction.report;
  if (!take_surface(extraction, options, design, notes)) return design;
  if (options.regions) design.regions = resolve_regions(mesh, options.unit, file, extraction, *options.regions);
  if (options.like != nullptr) return revised(std::move(design), options, start, progress, notes);
  const geometry::Surface surface(design.surface);
  const auto of_surface = regions_of(surface, design);
  const geometry::SurfaceRegions* const regions = of_surface.get();
  const SearchedSurface searched(surface, options);
  if (notes != nullptr) {
    notes->solver_faces = static_cast<int>(searched.surface().mesh().faces.size());
    notes->solver_deviation_mm = searched.solver() == nullptr ? 0.0 : searched.solver()->deviation_mm;
  }
  const geometry::Net net = pieces_of(searched.surface(), options, start, progress);
  const auto placed = place_pieces(design, net, options, start, progress);
  if (notes != nullptr) notes->pieces_left_out = static_cast<int>(net.pieces.size() - placed.size());
  report(progress, "mapping to the surface", -1.0);
  const double mapping_from_s = seconds_since(start);
  design::ModuleLayout mapped = mapped_layout(surface, searched, placed, options, regions, start);
  // The pieces name faces of the solver's mesh, which the design does not contain.
  if (searched.solver() != nullptr) design.pieces.clear();
  const double pricing_from_s = seconds_since(start);
  geometry::RoutingOptions routing = routing_options(design);
  routing.threads = options.threads;
  routing.give_up = give_up_at(start, pricing_from_s + kPiecesShare * options.time_limit_s, options.iterations);
  std::vector<WiredLayout> choices{priced(surface, std::move(mapped), options.limits, routing, regions)};
  const PiecesDone pieces = pieces_done(surface, choices[0].layout.modules.size(), pricing_from_s - mapping_from_s,
                                        seconds_since(start) - pricing_from_s, reading_s);
  if (notes != nullptr) notes->pieces = static_cast<int>(choices[0].layout.modules.size());
  std::vector<design::ModuleLayout> grown = grow(surface, searched.solver(), options, regions, start, pieces, progress);
  if (notes != nullptr) {
    notes->growth_left_out = grown.empty();
    notes->surface = grown.empty() ? 0 : static_cast<int>(grown[0].modules.size());
  }
  report(progress, "pricing", -1.0, fmt::format("{} layouts", grown.size()));
  routing.give_up = give_up_at(start, options.time_limit_s - pieces.wiring_s(), options.iterations);
  std::ranges::move(priced(surface, std::move(grown), options.limits, routing, regions, options.threads),
                    std::back_inserter(choices));
  std::ranges::stable_sort(choices, std::greater{}, &WiredLayout::value);
  design.alternatives = front_of(choices);
  design.layout = std::move(choices[0].layout);
  for (std::size_t k = 0; k < design.alternatives.size(); ++k) {
    if (design.alternatives[k].layout.modules.size() == design.layout.modules.size())
      design.taken = static_cast<int>(k);
  }
  design::assign_kinds_by_place(design.kinds, design.layout);
  wire(design, surface, regions, choices[0].places, progress, choices[0].division);
  design.report.seconds = seconds_since(start);
  return design;
}

}  // namespace triskin::pipeline

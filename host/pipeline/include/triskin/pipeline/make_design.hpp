// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "triskin/base/progress.hpp"
#include "triskin/design/design.hpp"
#include "triskin/design/region_file.hpp"
#include "triskin/mesh/bridge_holes.hpp"
#include "triskin/mesh/decimated_mesh.hpp"
#include "triskin/mesh/extract.hpp"
#include "triskin/mesh/mesh_io.hpp"
#include "triskin/mesh/side.hpp"
#include "triskin/pipeline/revise_design.hpp"
#include "triskin/pipeline/time_budget.hpp"

namespace triskin::pipeline {

/// What happens to a mesh that cannot be covered as it is.
enum class RepairMode : std::uint8_t {
  kAuto,   ///< It is repaired (geometry::ExtractOptions::repair).
  kNever,  ///< It is refused.
};

/// Where layouts are searched. The one of the highest value is kept.
enum class SearchMethod : std::uint8_t {
  kAuto,     ///< Grown on the surface; flat pieces are placed too where the surface is nearly developable.
  kPieces,   ///< Flat pieces are placed whatever the surface, and a layout is grown.
  kLattice,  ///< Only grown on the surface.
};

/// Options of make_design(). Out of range: InputError.
struct DesignOptions {
  std::optional<geometry::LengthUnit> unit;  ///< Without it the mesh file's own unit holds, or mm.
  cad::FaceSelection faces;                  ///< They are faces of a STEP or IGES file; an empty selection takes all.
  std::string object;  ///< It names one object of a mesh file with several; an empty name takes all.
  bool flip = false;   ///< All faces are turned over, which takes the other side of an open part.
  RepairMode repair = RepairMode::kAuto;
  SearchMethod method = SearchMethod::kAuto;
  geometry::SideOptions side;   ///< It chooses the side of a part with a wall.
  double bridge_mm = 0.0;       ///< Holes up to this diameter are closed; 0 closes none.
  double time_limit_s = 20.0;   ///< All steps share it (TimeBudget); the growth gets what the others leave.
  std::uint64_t seed = 1;       ///< It seeds every random choice.
  design::LayoutLimits limits;  ///< Each must be positive.
  /// > 0: no module is bent to a smaller radius: pieces are parted from what bends more (bend_seams.hpp), and depth and
  /// lift of modules are limited to the sagitta of a side, 112.5 mm² / radius; 0: not for that alone.
  double bend_radius_mm = 0.0;
  double corner_cut_mm = 0.0;  ///< Every module has this cut at its corners, 0 … design::kMaxCornerCut_mm.
  /// >= 0: how far the mesh on which pieces and growth are searched may be from a surface with more faces than it needs
  /// (decimated_mesh.hpp); 0: they are searched on the surface.
  double solver_deviation_mm = geometry::kSolverDeviation_mm;
  /// They say the worth of places, keep-outs and what must be covered (docs/regions.md).
  std::optional<design::RegionFile> regions;
  /// If positive, the growth ends after so many steps, so the result repeats whatever the machine's load.
  int iterations = 0;
  int threads = 2;      ///< The growth has so many chains, 1 … 256, and the result depends on their number.
  design::Price price;  ///< Each is 0 … 16 modules; jumpers may be as long as limits.jumper_mm.
  /// Design of an older version of the part, whose modules stay where they can (revise_design.hpp); its limits, price,
  /// seed and kinds are taken then, and its choice of faces where `faces` is empty. Null: none.
  std::shared_ptr<const design::Design> like;
  /// Kinds of the modules by place. Only spheres and boxes are possible, since modules have no numbers yet.
  design::KindPlan kinds;
};

/// How a design came about: number of modules that each method gave (design::LayoutMethod), what was made of the mesh.
struct DesignNotes {
  std::vector<std::string> reading;  ///< They are the notes of the mesh file's reader (mesh_io.hpp).
  int pieces = 0, surface = 0;
  int solver_faces = 0;              ///< The mesh that was searched, perhaps the surface itself, has so many faces.
  double solver_deviation_mm = 0.0;  ///< That mesh is proved to be at most so far from the surface.
  int pieces_left_out = 0;           ///< So many pieces were not placed because the time was over.
  double curvature_rad = 0.0;        ///< Mean integral of |Gaussian curvature| under a module; 0 without a search.
  std::vector<StepTime> steps;       ///< What each step was granted and took of the time limit.
  geometry::ExtractReport extract;
  geometry::TakenSide side;
  geometry::BridgeReport bridges;
  geometry::Mesh part;  ///< The side was taken from it; it is filled only where the side is undecided.
  geometry::MeshReadReport read;
  std::optional<Revision> revision;  ///< with DesignOptions::like
};

/// The design with the alternative `index` (0-based, design.alternatives) in place of its layout, measured and wired
/// anew: without a search. Alternatives stay. Errors: InputError naming the range for an index that is not there.
/// Deterministic for the seed of the design. Cost: about 0.5 s for 150 modules.
[[nodiscard]] design::Design take_alternative(const design::Design& design, int index,
                                              const ProgressSink& progress = {});

/// Makes a design of a mesh file: extract, unfold, certified placement of each piece, rigid modules on the surface,
/// jumpers, controllers and wiring; of the pieces and the lattice grown on the surface the layout of higher value,
/// worth of the modules less price, stays. What is reported is measured on the surface, also where the search had a
/// mesh of its own; then the design has no `pieces`, which are made of faces of the surface. Fills `notes` when it is
/// given. Where both sides of a part look alike (DesignNotes::side) the design has no modules. Errors: InputError for
/// unusable meshes and options out of range. Deterministic for seed, threads and iterations unless the time limit cuts
/// a search short. Cost: about time_limit_s, less where `iterations` ends the growth sooner.
[[nodiscard]] design::Design make_design(const std::filesystem::path& mesh, const DesignOptions& options,
                                         const ProgressSink& progress = {}, DesignNotes* notes = nullptr);

}  // namespace triskin::pipeline

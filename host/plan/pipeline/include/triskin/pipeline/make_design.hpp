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

/// Tells what happens to a mesh that cannot be covered as it is.
enum class RepairMode : std::uint8_t {
  kAuto,   ///< The mesh is repaired (mesh::ExtractOptions::repair).
  kNever,  ///< The mesh is refused.
};

/// Tells where layouts are searched. The layout of the highest value is kept.
enum class SearchMethod : std::uint8_t {
  kAuto,     ///< A layout is grown on the surface; flat pieces are placed too where the surface is nearly developable.
  kPieces,   ///< Flat pieces are placed on every surface, and a layout is grown.
  kLattice,  ///< A layout is grown on the surface, and no pieces are placed.
};

/// Joints of a new design fold by at most 49.8° by default, because the board of a module can be bent by 50°
/// (docs/fabrication.md); design::LayoutLimits allows the 60° of the installed iCub skin.
inline constexpr double kBoardFold_rad = 0.87;

/// make_design() throws InputError for a value out of range.
struct DesignOptions {
  std::optional<mesh::LengthUnit> unit;  ///< Without it the mesh file's own unit applies, or mm.
  cad::FaceSelection faces;              ///< Selects faces of a STEP or IGES file; an empty selection takes all.
  std::string object;                    ///< Selects one object of a mesh file with several; an empty name takes all.
  bool flip = false;                     ///< True turns all faces over, which takes the other side of an open part.
  RepairMode repair = RepairMode::kAuto;
  SearchMethod method = SearchMethod::kAuto;
  mesh::SideOptions side;      ///< Selects the side of a part with a wall.
  double bridge_mm = 0.0;      ///< Holes up to this diameter are closed; 0 closes none.
  double time_limit_s = 20.0;  ///< All steps share this time (TimeBudget); the growth gets what the others leave.
  std::uint64_t seed = 1;      ///< All random choices depend on this number.
  design::LayoutLimits limits{.fold_rad = kBoardFold_rad};  ///< Each must be positive.
  /// If positive, no module is bent to a smaller radius: pieces are separated from surface that bends more
  /// (bend_seams.hpp), and depth and lift of modules are limited to the sagitta of a side, 112.5 mm² / radius. Zero
  /// disables this.
  double bend_radius_mm = 0.0;
  double corner_cut_mm = 0.0;  ///< Every module has this cut at its corners, 0 … design::kMaxCornerCut_mm.
  /// The mesh on which pieces and growth are searched may be this far (>= 0) from a surface with more faces than it
  /// needs (decimated_mesh.hpp); 0 searches on the surface itself.
  double solver_deviation_mm = mesh::kSolverDeviation_mm;
  /// States the worth of places, keep-outs and what must be covered (docs/regions.md).
  std::optional<design::RegionFile> regions;
  /// If positive, the growth ends after this many steps, so the result repeats whatever the machine's load.
  int iterations = 0;
  int threads = 2;      ///< The growth has this many chains, 1 … 256, and the result depends on their number.
  design::Price price;  ///< Each is 0 … 16 modules; jumpers may be as long as limits.jumper_mm.
  /// Design of an older version of the part, whose modules stay if they can (revise_design.hpp); its limits, price,
  /// seed and kinds are then taken, and its choice of faces if `faces` is empty. Null means none.
  std::shared_ptr<const design::Design> like;
  /// Assigns the kinds of the modules by place. Only spheres and boxes are possible, since modules have no numbers yet.
  design::KindPlan kinds;
};

/// Tells how a design was made: the number of modules from each method (design::LayoutMethod), and what was done to the
/// mesh.
struct DesignNotes {
  std::vector<std::string> reading;  ///< The reader of the mesh file wrote these notes (mesh_io.hpp).
  int pieces = 0, surface = 0;
  int solver_faces = 0;              ///< The mesh that was searched, perhaps the surface itself, has this many faces.
  double solver_deviation_mm = 0.0;  ///< That mesh is proved to be at most this far from the surface.
  int pieces_left_out = 0;           ///< This many pieces were not placed because the time was over.
  double curvature_rad = 0.0;        ///< The integral of |Gaussian curvature| falls on a module with this mean.
  std::vector<StepTime> steps;       ///< Each step states the time that it was granted and that it took.
  mesh::ExtractReport extract;
  mesh::TakenSide side;
  mesh::BridgeReport bridges;
  design::Mesh part;  ///< The side was taken from this part; it is filled only if the side is undecided.
  mesh::MeshReadReport read;
  std::optional<Revision> revision;  ///< Only DesignOptions::like fills this.
};

struct DesignResult {
  design::Design design;
  DesignNotes notes;
};

/// Returns the design with the alternative `index` (0-based, design.alternatives) in place of its layout, measured and
/// wired anew, without a search. Alternatives stay. Errors: InputError naming the range for an index that does not
/// exist. Deterministic for the seed of the design. Cost: about 0.5 s for 150 modules.
[[nodiscard]] design::Design take_alternative(const design::Design& design, int index,
                                              const ProgressSink& progress = {});

/// Makes a design of a mesh file: extract, unfold, certified placement of each piece, rigid modules on the surface,
/// jumpers, controllers and wiring. Of the layouts on pieces and the lattice grown on the surface it takes the one of
/// higher value, worth of the modules less price. All reported values are measured on the surface, even if the search
/// had a mesh of its own; then the design has no `pieces`, which are made of faces of the surface. If both sides of a
/// part look alike (DesignNotes::side) the design has no modules. Errors: InputError
/// for unusable meshes and options out of range. Deterministic for seed, threads and iterations unless the time limit
/// cuts a search short. Cost: about time_limit_s, or less if `iterations` ends the growth sooner.
[[nodiscard]] DesignResult make_design(const std::filesystem::path& mesh, const DesignOptions& options,
                                       const ProgressSink& progress = {});

}  // namespace triskin::pipeline

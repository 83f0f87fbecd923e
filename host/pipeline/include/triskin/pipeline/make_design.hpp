// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <optional>

#include "triskin/design/design.hpp"
#include "triskin/geometry/mesh_io.hpp"
#include "triskin/host/progress.hpp"

namespace triskin::pipeline {

/// Options of make_design(). Out of range: InputError.
struct DesignOptions {
  std::optional<geometry::LengthUnit> unit;  ///< of the mesh file; none: its own or mm
  double time_limit_s = 20.0;   ///< > 0, of all steps together; what placement and wiring leave goes to the growth
  std::uint64_t seed = 1;       ///< of every random choice
  design::LayoutLimits limits;  ///< each > 0
  double bend_radius_mm = 0.0;  ///< > 0: pieces are parted from what bends more (bend_seams.hpp); 0: not for that alone
  double corner_cut_mm = 0.0;   ///< 0 … design::kMostCornerCut_mm: of every module
  int iterations = 0;         ///< ≥ 0; > 0: the growth ends after so many steps: repeatable whatever the machine's load
  int threads = 2;            ///< 1 … 256 chains of the growth; part of what a result depends on
  double island_cost = 0.05;  ///< 0 … 16 modules that an island (its cable) is worth
  double controller_cost = 0.05;  ///< 0 … 16 modules that a controller is worth
};

/// Number of modules that each method gave (design::LayoutMethod).
struct MethodComparison {
  int pieces = 0, surface = 0;
};

/// Makes a design of a mesh file: extract, unfold, certified placement of each piece, rigid modules on the surface,
/// controllers and wiring; of the pieces and the lattice grown on the surface the layout of higher value stays. Fills
/// `comparison` when it is given. Errors: InputError for unusable meshes and options out of range. Deterministic for
/// seed, threads and iterations unless the time limit cuts a search short. Cost: about time_limit_s,
/// less where `iterations` ends the growth sooner.
[[nodiscard]] design::Design make_design(const std::filesystem::path& mesh, const DesignOptions& options,
                                         const ProgressSink& progress = {}, MethodComparison* comparison = nullptr);

}  // namespace triskin::pipeline

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <optional>

#include "triskin/design/design.hpp"
#include "triskin/geometry/mesh_io.hpp"
#include "triskin/host/progress.hpp"

namespace triskin::pipeline {

struct DesignOptions {
  std::optional<geometry::LengthUnit> unit;
  double time_limit_s = 20.0;
  std::uint64_t seed = 1;
  design::LayoutLimits limits;
  int iterations = 0;  ///< > 0: the growth ends after so many steps: repeatable whatever the machine's load
  int threads = 2;
  double island_cost = 0.05;      ///< modules that an island (its cable) is worth
  double controller_cost = 0.05;  ///< modules that a controller is worth
};

/// Modules that each way of covering the surface gave.
struct MethodComparison {
  int pieces = 0, surface = 0;
};

/// Mesh file → design: extract, unfold, certified placement of each piece, rigid modules on the surface, controllers
/// and wiring; of the pieces and the lattice grown on the surface the layout of higher value stays. Throws InputError
/// for unusable meshes. Deterministic for a seed unless the time limit cuts a search short.
[[nodiscard]] design::Design make_design(const std::filesystem::path& mesh, const DesignOptions& options,
                                         const ProgressSink& progress = {}, MethodComparison* comparison = nullptr);

}  // namespace triskin::pipeline

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <optional>

#include "triskin/geometry/mesh_io.hpp"
#include "triskin/host/progress.hpp"
#include "triskin/model/design.hpp"

namespace triskin::model {

struct DesignOptions {
  std::optional<geometry::LengthUnit> unit;
  double time_limit_s = 20.0;
  std::uint64_t seed = 1;
  geometry::LayoutLimits limits;
};

/// Mesh file → design: extract, unfold, certified placement of each piece, rigid modules on the surface, controllers and
/// wiring. Throws InputError for unusable meshes. Deterministic for a seed unless the time limit cuts a search short.
[[nodiscard]] Design make_design(const std::filesystem::path& mesh, const DesignOptions& options, const ProgressSink& progress = {});

}  // namespace triskin::model

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "triskin/mesh/decimated_mesh.hpp"
#include "triskin/mesh/surface.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::pipeline {

/// The surface on which pieces and growth are searched: the original, or a decimated mesh of it.
class SearchedSurface {
 public:
  /// `original` must live as long as this.
  SearchedSurface(const geometry::Surface& original, const DesignOptions& options)
      : original_(original),
        solver_(geometry::solver_mesh_of(original, options.limits, options.solver_deviation_mm, options.threads)) {
    if (solver_) reduced_.emplace(solver_->mesh);
  }

  [[nodiscard]] const geometry::Surface& original() const { return original_; }
  [[nodiscard]] const geometry::Surface& surface() const { return reduced_ ? *reduced_ : original_; }
  /// Null when the original is searched.
  [[nodiscard]] const geometry::DecimatedMesh* solver() const { return solver_ ? &*solver_ : nullptr; }

 private:
  const geometry::Surface& original_;
  std::optional<geometry::DecimatedMesh> solver_;
  std::optional<geometry::Surface> reduced_;
};

}  // namespace triskin::pipeline

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "triskin/mesh/decimated_mesh.hpp"
#include "triskin/mesh/surface.hpp"
#include "triskin/pipeline/make_design.hpp"

namespace triskin::pipeline {

/// Pieces and growth are searched on this surface: the original, or a decimated mesh if that has far fewer faces.
class SearchedSurface {
 public:
  /// `original` must live as long as this object.
  SearchedSurface(const mesh::Surface& original, const DesignOptions& options)
      : original_(original),
        solver_(mesh::solver_mesh_of(original, options.limits, options.solver_deviation_mm, options.threads)) {
    if (solver_) reduced_.emplace(solver_->mesh);
  }

  [[nodiscard]] const mesh::Surface& original() const { return original_; }
  [[nodiscard]] const mesh::Surface& surface() const { return reduced_ ? *reduced_ : original_; }
  /// Returns null if the original itself is searched.
  [[nodiscard]] const mesh::DecimatedMesh* solver() const { return solver_ ? &*solver_ : nullptr; }

 private:
  const mesh::Surface& original_;
  std::optional<mesh::DecimatedMesh> solver_;
  std::optional<mesh::Surface> reduced_;
};

}  // namespace triskin::pipeline

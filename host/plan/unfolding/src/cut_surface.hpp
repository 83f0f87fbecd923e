// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "triskin/mesh/surface.hpp"

namespace triskin::unfolding {

/// Represents a surface some of whose sides are cut open. Faces are joined only across the other sides.
class CutSurface {
 public:
  explicit CutSurface(const mesh::Surface& surface)
      : surface_(surface), cut_(surface.mesh().faces.size(), {false, false, false}) {}

  [[nodiscard]] const mesh::Surface& surface() const { return surface_; }
  /// Returns the face across side s, −1 at the border and at a cut.
  [[nodiscard]] FaceIndex neighbour(FaceIndex face, int side) const {
    return cut_[static_cast<std::size_t>(face)][static_cast<std::size_t>(side)]
               ? FaceIndex::none()
               : surface_.neighbours(face)[static_cast<std::size_t>(side)];
  }
  /// Cuts or joins an edge, seen from one of its faces; the border stays as it is.
  void set(FaceIndex face, int side, bool cut) {
    const FaceIndex other = surface_.neighbours(face)[static_cast<std::size_t>(side)];
    if (other < 0) return;
    cut_[static_cast<std::size_t>(face)][static_cast<std::size_t>(side)] = cut;
    for (std::size_t s = 0; s < 3; ++s) {
      if (surface_.neighbours(other)[s] == face && shares(face, side, other, s))
        cut_[static_cast<std::size_t>(other)][s] = cut;
    }
  }

 private:
  [[nodiscard]] bool shares(FaceIndex face, int side, FaceIndex other, std::size_t other_side) const {
    const auto &f = surface_.mesh().faces[static_cast<std::size_t>(face)],
               &g = surface_.mesh().faces[static_cast<std::size_t>(other)];
    return f[static_cast<std::size_t>(side)] == g[(other_side + 1) % 3];
  }

  const mesh::Surface& surface_;
  std::vector<std::array<bool, 3>> cut_;
};

}  // namespace triskin::unfolding

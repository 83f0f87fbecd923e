// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <optional>
#include <span>

#include "triskin/design/design_types.hpp"

namespace triskin::mesh {

/// Projects the faces around a corner along their mean normal and measures how much the surface changes when the corner
/// is collapsed onto one of its neighbours.
class FlatStar {
 public:
  static constexpr std::size_t kMaxCorners = 48;  ///< A vertex with more neighbours is not collapsed.

  /// `ring` has the neighbours of the middle, counter-clockwise, at most kMaxCorners; those of an open star (at a
  /// border) run from one border edge to the other.
  FlatStar(const Vec3& middle, std::span<const Vec3> ring, bool is_open);

  /// Returns true if the projected faces lie side by side without overlap and none is turned over. The other queries
  /// need this.
  [[nodiscard]] bool is_flat() const { return is_flat_; }

  struct Change {
    /// No point of the old faces is farther from the new ones than this, nor the other way round.
    double deviation_mm;
    double border_mm;  ///< The border has the same bound; it is 0 for a closed star.
    double shape;      ///< The worst new face has this height over its longest edge, 0 … 0.87.
  };
  /// Collapses the middle onto ring[j]; in an open star only the first and the last are allowed. Returns nothing if the
  /// new faces would overlap, would be needles or would lean more than the old ones. Needs is_flat().
  [[nodiscard]] std::optional<Change> onto(std::size_t j) const;

 private:
  struct Corner {
    double x, y, z;  // The position is relative to the middle, with z along the mean normal.
  };
  struct Face {
    double shape, lean;  // `lean` is the cosine between the normal of the face and the mean normal.
  };
  [[nodiscard]] std::size_t faces() const { return is_open_ ? size_ - 1 : size_; }
  [[nodiscard]] std::size_t next(std::size_t k) const { return k + 1 == size_ ? 0 : k + 1; }
  [[nodiscard]] bool is_beside(std::size_t j, std::size_t k) const;
  [[nodiscard]] static double twice_area(const Corner& a, const Corner& b, const Corner& c);
  [[nodiscard]] static Face face_of(const Corner& a, const Corner& b, const Corner& c);
  [[nodiscard]] bool turns_once() const;
  [[nodiscard]] std::optional<double> worst_new_shape(std::size_t j) const;
  [[nodiscard]] double between(std::size_t j) const;
  [[nodiscard]] double at_middle(std::size_t j) const;
  [[nodiscard]] double at_crossings(std::size_t j, std::size_t q) const;

  std::size_t size_;
  bool is_open_, is_flat_ = false;
  std::array<Corner, kMaxCorners> ring_;
  double old_shape_ = 1.0, old_lean_ = 1.0;  // The worst of the old faces has these values.
  double border_mm_ = 0.0;  // The middle is this far from the edge that would replace its two border edges.
};

}  // namespace triskin::mesh

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <optional>
#include <span>

#include "triskin/design/design_types.hpp"

namespace triskin::geometry {

/// The faces round a corner of a surface, seen along their mean normal: what a surface changes by when the corner is
/// drawn onto one of its neighbours.
class FlatStar {
 public:
  static constexpr std::size_t kMaxCorners = 48;  ///< A vertex with more neighbours is left alone.

  /// `ring`: the neighbours of the middle, counter-clockwise, at most kMaxCorners; of an open star (at a border) from
  /// one border edge to the other.
  FlatStar(const Vec3& middle, std::span<const Vec3> ring, bool is_open);

  /// True if the faces lie side by side, none over another and none turned over: nothing is known of others.
  [[nodiscard]] bool is_flat() const { return is_flat_; }

  struct Change {
    /// No point of the old faces is farther from the new ones than this, nor the other way round.
    double deviation_mm;
    double border_mm;  ///< It is the same bound for the border, and 0 for a closed star.
    double shape;      ///< It is the worst new face's height over its longest edge, 0 … 0.87.
  };
  /// The middle drawn onto ring[j]; of an open star the first or the last. None where the new faces would not lie side
  /// by side, or would be needles or lean more than the old ones do. Needs is_flat().
  [[nodiscard]] std::optional<Change> onto(std::size_t j) const;

 private:
  struct Corner {
    double x, y, z;  // Position relative to the middle; z along the mean normal.
  };
  struct Face {
    double shape, lean;  // Lean is the cosine between its normal and the mean.
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
  double old_shape_ = 1.0, old_lean_ = 1.0;  // Values of the worst old face.
  double border_mm_ = 0.0;                   // Distance from the middle to the edge that replaces its two border edges.
};

}  // namespace triskin::geometry

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/design/design_types.hpp"

namespace triskin::lattice {

/// Copies a mesh into a frame of its own — middle of its area, principal axes, the longer side first —, on a grid
/// of 1/256 mm, its corners and faces in the order of their places. Copies that are turned, shifted, mirrored or
/// renumbered give the same mesh, so that the search, which depends on every digit, gives the same layout. If two axes
/// are alike the copies may differ.
class CanonicalCopy {
 public:
  /// Makes the copy and the motion that leads back. Cost: O(n log n).
  explicit CanonicalCopy(const Mesh& original);

  [[nodiscard]] const Mesh& mesh() const { return mesh_; }
  [[nodiscard]] Vec3 to_original(const Vec3& p) const {
    return middle_ + p.x() * axis_[0] + p.y() * axis_[1] + p.z() * axis_[2];
  }
  [[nodiscard]] Vec3 to_copy(const Vec3& p) const {
    return {axis_[0].dot(p - middle_), axis_[1].dot(p - middle_), axis_[2].dot(p - middle_)};
  }
  /// Moves a layout on this copy back to the original: corners are moved, and if the copy is a mirror image, so are
  /// tiles.
  void carry_back(ModuleLayout& layout) const;
  /// Moves a module of the original to this copy.
  [[nodiscard]] PlacedModule carried_there(PlacedModule module) const;

 private:
  void choose_axes(const Mesh& original);
  void move_and_sort(const Mesh& original, bool on_grid);

  Mesh mesh_;
  Vec3 middle_ = Vec3::Zero();
  std::array<Vec3, 3> axis_{Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  bool mirrored_ = false;
};

}  // namespace triskin::lattice

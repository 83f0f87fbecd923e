// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "triskin/mesh/surface.hpp"

namespace triskin::geometry::surface_lattice {

/// Foot of a point on the surface.
struct Foot {
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitZ();  ///< It is interpolated, as Surface::normal_at does.
  double distance_mm = 0.0;
  bool on_border = false;  ///< The foot lies on a border edge.
};

/// Closest points of a surface, several times faster than Surface::closest and with the same answers: each voxel of a
/// grid keeps the faces that can be nearest to a point in it. Fills itself while it is used: one object a thread.
class NearSurface {
 public:
  explicit NearSurface(const Surface& surface);

  [[nodiscard]] Foot closest(const Vec3& query_mm);
  /// Lower bound of the distance to the border, a few mm below it.
  [[nodiscard]] double border_at_least(const Vec3& query_mm);
  /// False only where the foot of a point surely does not lie on the border.
  [[nodiscard]] bool may_be_over_border(const Vec3& query_mm);
  [[nodiscard]] const Surface& surface() const { return surface_; }

 private:
  struct Voxel {
    /// They are candidates; a count of −1 means too many or too far away, so the tree is asked.
    int first = 0, count = -1;
    double border_mm = 0.0;   ///< No point of the voxel is nearer to the border.
    bool may_be_over = true;  ///< A foot may lie on the border.
    Vec3 middle = Vec3::Zero();
  };
  [[nodiscard]] const Voxel* voxel_at(const Vec3& query_mm);
  [[nodiscard]] int fill(const Vec3& middle);
  [[nodiscard]] Foot foot_on(int face, const Vec3& weights, const Vec3& point, double squared) const;

  const Surface& surface_;
  Vec3 origin_ = Vec3::Zero();
  double size_mm_ = 5.0, per_mm_ = 0.2;  ///< They are the side of a voxel and the number of voxels for each mm.
  std::array<int, 3> voxels_{};
  std::vector<int> index_;  ///< Each voxel has its entry in `filled_`, or −1 when it was never asked for.
  std::vector<Voxel> filled_;
  struct Candidate {
    int face;
    double distance_mm;  ///< It is measured from the middle of the voxel.
  };
  std::vector<Candidate> candidates_;
  std::vector<bool> border_vertex_, border_face_;
};

}  // namespace triskin::geometry::surface_lattice

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "ray_caster.hpp"

namespace triskin::mesh {

/// Approximates the convex hull of points by half spaces in many directions. It exceeds the hull by little: on a sphere
/// of radius r by r / 1,000.
class HullDepth {
 public:
  /// Finds the extreme point in each direction. Cost: O(n).
  explicit HullDepth(const std::vector<Vec3>& points_mm);

  /// Returns the distance from a point along a unit normal to where it leaves the hull; 0 on the hull. Cost: constant.
  [[nodiscard]] double along(const Vec3& point_mm, const Vec3& normal) const;
  /// Returns true if the other hull lies more than `by_mm` under this one in every direction. Cost: constant.
  [[nodiscard]] bool encloses(const HullDepth& other, double by_mm) const;
  /// Returns the mean height over the origin in all directions, which grows with the size. Cost: constant.
  [[nodiscard]] double mean_height_mm() const;

 private:
  std::vector<double> heights_mm_;  // Each direction has the height of the hull along it.
  std::vector<Vec3> extremes_mm_;   // These points lie on the hull, at most one for each direction.
};

/// Returns the cosine-weighted fraction of the half sphere above a point, 0 … 1, in which no ray meets the part.
/// `turn` (any number) rotates the rays, so that neighbouring points do not share the same error. Cost: `rays` rays.
[[nodiscard]] double visibility_of(const RayCaster& part, const Vec3& point_mm, const Vec3& normal, int rays,
                                   unsigned turn);

}  // namespace triskin::mesh

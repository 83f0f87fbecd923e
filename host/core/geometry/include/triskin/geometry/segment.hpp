// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <concepts>

namespace triskin::geometry {

/// A point of the plane or of space.
template <class V>
concept Point = std::same_as<V, Eigen::Vector2d> || std::same_as<V, Eigen::Vector3d>;

/// Returns where on the segment from a to b the point nearest to p lies: 0 at a … 1 at b. A segment whose length
/// squared is 0 in double precision (shorter than 1e-162) is its point a. The ends must be finite; p may be infinite.
template <Point V>
[[nodiscard]] double part_of_segment(const V& p, const V& a, const V& b) {
  const V along = b - a;
  const double part = (p - a).dot(along) / along.squaredNorm();
  if (!(part > 0.0)) return 0.0;  // Also for equal ends (0/0) and an infinite p that is at no side (∞ − ∞).
  return part < 1.0 ? part : 1.0;
}

/// Returns the point of the segment from a to b that is nearest to p.
template <Point V>
[[nodiscard]] V closest_on_segment(const V& p, const V& a, const V& b) {
  return a + part_of_segment(p, a, b) * (b - a);
}

/// Returns the distance of p from the segment from a to b, in the unit of the points; infinity for an infinite p.
template <Point V>
[[nodiscard]] double distance_to_segment(const V& p, const V& a, const V& b) {
  return (closest_on_segment(p, a, b) - p).norm();
}

/// Returns whether the ray from p towards +x crosses the segment from a to b, which has its lower end but not its upper
/// one. p is inside a ring whose sides it crosses an odd number of times; on a side it may be either.
[[nodiscard]] inline bool ray_crosses(const Eigen::Vector2d& p, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return (a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
}

}  // namespace triskin::geometry

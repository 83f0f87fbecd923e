// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace triskin::geometry {

using Triangle = std::array<Eigen::Vector3d, 3>;

/// Returns the normal of a triangle with twice its area as length; counter-clockwise corners look against it.
[[nodiscard]] inline Eigen::Vector3d twice_area_normal(const Triangle& t) {
  return (t[1] - t[0]).cross(t[2] - t[0]);
}

[[nodiscard]] inline double area_of(const Triangle& t) {
  return 0.5 * twice_area_normal(t).norm();
}

/// Returns the angle between two unit vectors: 0 … π, also where rounding makes their product exceed 1.
[[nodiscard]] inline double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::acos(std::clamp(a.dot(b), -1.0, 1.0));
}

/// Returns the point of triangle (a, b, c) nearest to p, as barycentric weights (≥ 0, sum 1). Triangles without
/// area are the segments or the point that they look like. Corners must be finite; an infinite p gives some corner.
/// Constant cost. Source: C. Ericson, Real-Time Collision Detection, 5.1.5.
[[nodiscard]] Eigen::Vector3d closest_on_triangle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                                  const Eigen::Vector3d& b, const Eigen::Vector3d& c);

/// Returns that point itself.
[[nodiscard]] Eigen::Vector3d closest_point_on_triangle(const Eigen::Vector3d& p, const Triangle& t);

/// Returns the distance of p from triangle t, in the unit of the points; infinity for an infinite p.
[[nodiscard]] double distance_to_triangle(const Eigen::Vector3d& p, const Triangle& t);

}  // namespace triskin::geometry

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <functional>
#include <vector>

namespace triskin::mechanics {

/// A rigid body above the layer, which lies in the plane z = 0 with its surface towards +z. Only the lower surface of a
/// body matters: its height over each point of the plane, infinite beside the body. Lengths that are not positive and
/// triangles that name a vertex that does not exist throw InputError.
class Body {
 public:
  /// Makes a sphere about the origin of the body. Throws InputError for a radius that is not positive.
  [[nodiscard]] static Body sphere(double radius_mm);
  /// Makes a capsule about the segment from `first` to `second`. Throws InputError for a radius that is not positive.
  [[nodiscard]] static Body capsule(double radius_mm, const Eigen::Vector3d& first, const Eigen::Vector3d& second);
  /// Makes a box of the given edge lengths about the origin, turned by `rotation`. Throws InputError for a length that
  /// is not positive.
  [[nodiscard]] static Body box(const Eigen::Vector3d& size_mm, const Eigen::Matrix3d& rotation);
  /// Takes a closed or open triangle mesh. Each triangle is seen from below. Throws InputError for a vertex that does
  /// not exist.
  [[nodiscard]] static Body mesh(std::vector<Eigen::Vector3d> vertices, std::vector<std::array<int, 3>> triangles);

  /// Returns the height in mm of the lower surface over (x, y), or infinity. Cost: constant, for a capsule some 60
  /// evaluations of a distance, for a mesh proportional to its triangles. Thread-safe.
  [[nodiscard]] double lower_surface_mm(double x_mm, double y_mm) const { return lower_surface_(x_mm, y_mm); }

 private:
  explicit Body(std::function<double(double, double)> lower_surface) : lower_surface_(std::move(lower_surface)) {}
  std::function<double(double, double)> lower_surface_;
};

}  // namespace triskin::mechanics

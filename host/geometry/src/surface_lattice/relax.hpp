// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <vector>

#include "net.hpp"
#include "triskin/geometry/surface.hpp"

namespace triskin::geometry::surface_lattice {

/// Slides the corners near a place on the surface until edges are 30 mm long, nothing stands over the border and modules do
/// not overlap: damped Gauss–Newton over two tangent coordinates a corner. Work arrays are kept between calls; one
/// object a thread.
class Relaxer {
 public:
  Relaxer(const Surface& surface, double corner_lift_mm) : surface_(surface), lift_mm_(corner_lift_mm) {}

  /// Moves the vertices within `radius_mm` of a triangle that was just added. Afterwards `changed()` lists the triangles that moved.
  void relax(LatticeNet& net, int triangle, double radius_mm, int steps);
  /// Takes back the last relax (triangles added before it stay).
  void undo(LatticeNet& net) const;
  [[nodiscard]] const std::vector<int>& changed() const { return changed_; }

 private:
  struct Frame {
    Vec3 x, y;
  };
  void choose(const LatticeNet& net, const Vec3& place, double radius_mm);
  [[nodiscard]] bool hopeless(const LatticeNet& net, int triangle) const;
  void find_pairs(const LatticeNet& net);
  double step(LatticeNet& net);
  void add_edges(const LatticeNet& net);
  void add_pairs(const LatticeNet& net);
  void add_border(const LatticeNet& net);
  void add_residual(double value, double weight, const std::array<int, 2>& vertex, const std::array<Vec3, 2>& gradient);
  void move(LatticeNet& net, int local, const Vec3& by) const;
  void adapt_lift(LatticeNet& net);
  void settle(LatticeNet& net);

  const Surface& surface_;
  double lift_mm_;
  std::vector<int> local_;                    // vertex → index among the moving ones, or -1
  std::vector<int> moving_, triangles_, changed_;
  std::vector<NetVertex> saved_;
  std::vector<std::array<int, 2>> pairs_;
  std::vector<Frame> frames_;
  Eigen::MatrixXd matrix_;
  Eigen::VectorXd right_;
};

}  // namespace triskin::geometry::surface_lattice

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "triskin/lattice/envelope.hpp"
#include "triskin/lattice/near_surface.hpp"
#include "triskin/lattice/net.hpp"
#include "triskin/lattice/overlap.hpp"

namespace triskin::geometry::surface_lattice {

/// Slides the corners near a place on the surface until edges are 30 mm long, nothing stands over the border and
/// modules do not overlap: damped Gauss–Newton over two tangent coordinates a corner. Work arrays are kept between
/// calls; one object a thread.
class Relaxer {
 public:
  Relaxer(NearSurface& surface, double corner_lift_mm) : surface_(surface), lift_mm_(corner_lift_mm) {}

  /// Moves the vertices within `radius_mm` of a triangle that was just added. Afterwards `changed()` lists it and the
  /// triangles that moved. False: it cannot fit; the remaining steps are skipped and `changed()` is empty.
  bool relax(LatticeMesh& net, int triangle, double radius_mm, int steps);
  /// Takes back the last relax (triangles added before it stay).
  void undo(LatticeMesh& net) const;
  [[nodiscard]] const std::vector<int>& changed() const { return changed_; }
  /// Pairs of unjoined triangles that are near enough to overlap, where one may have moved.
  [[nodiscard]] std::vector<Pair>& pairs() { return pairs_; }

 private:
  struct Moving {
    int vertex;
    double key;  // Position along the line that sorts them.
    Vec3 x, y;   // Axes of the tangent frame.
    Vec3 saved_point, saved_normal;
    double saved_lift_mm;
    double wanted_lift_mm;
    bool is_lifted;  // The last apply_lift() lifted or lowered it.
  };
  struct KnownGap {
    Vec3 center = Vec3::Zero();
    double distance_mm = 1e300;  // Distance of the centre from the surface.
  };
  struct Residual {
    double value, weight;
    std::array<int, 2> local;  // Moving vertices, −1: fixed; the first is never −1.
    std::array<std::array<double, 2>, 2> gradient;
  };
  void choose(const LatticeMesh& net, int triangle, double radius_mm);
  void find_pairs(const LatticeMesh& net);
  [[nodiscard]] bool overlaps(const LatticeMesh& net, int triangle, double depth_mm);
  double step(LatticeMesh& net);
  void add_edges(const LatticeMesh& net);
  void add_pairs(const LatticeMesh& net);
  void add_border(const LatticeMesh& net);
  void add_side_at_border(const NetTriangle& triangle, std::size_t side);
  double add_point_at_border(const NetTriangle& triangle, std::size_t side, double x);
  void add_residual(double value, double weight, const std::array<int, 2>& vertex, const std::array<Vec3, 2>& gradient);
  void solve();
  void move(LatticeMesh& net, const Moving& moving, const Vec3& by);
  void adapt_lift(LatticeMesh& net);
  [[nodiscard]] double height_of_surface(int t, const NetTriangle& triangle);
  void apply_lift(LatticeMesh& net);
  void settle(LatticeMesh& net, int triangle);

  NearSurface& surface_;
  double lift_mm_;
  double overhang_mm_ = 0.0;  // Corners may extend over the border by this much because they are cut off.
  std::vector<int> local_;    // Maps a vertex to its index among the moving ones, or -1.
  std::vector<Moving> moving_;
  std::vector<int> triangles_, near_, changed_;
  std::vector<ModuleShape> saved_;    // Former shapes of triangles_.
  std::vector<KnownGap> known_gaps_;  // Indexed by triangle: where its centre was measured last.
  std::vector<char> is_local_;        // Indexed by triangle: true if it is in triangles_.
  std::vector<Pair> pairs_;
  std::vector<Residual> residuals_;
  std::vector<int> first_;
  EnvelopeSystem system_;
};

}  // namespace triskin::geometry::surface_lattice

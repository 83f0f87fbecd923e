// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "envelope.hpp"
#include "near_surface.hpp"
#include "net.hpp"
#include "overlap.hpp"

namespace triskin::lattice {

/// Slides the corners near a place on the surface until edges are 30 mm long, nothing overhangs the border and modules
/// do not overlap: damped Gauss–Newton over two tangent coordinates per corner. Work arrays are kept between calls,
/// so each thread needs its own object.
class Relaxer {
 public:
  Relaxer(NearSurface& surface, double corner_lift_mm) : surface_(surface), lift_mm_(corner_lift_mm) {}

  /// Moves the vertices within `radius_mm` of a triangle that was just added. Afterwards `changed()` lists it and the
  /// triangles that moved. Returns false if it cannot fit; the remaining steps are skipped and `changed()` is empty.
  bool relax(LatticeMesh& net, int triangle, double radius_mm, int steps);
  /// Undoes the last relax (triangles added before it stay).
  void undo(LatticeMesh& net) const;
  [[nodiscard]] const std::vector<int>& changed() const { return changed_; }
  /// Returns pairs of unjoined triangles that are near enough to overlap, one of which may have moved.
  [[nodiscard]] std::vector<Pair>& pairs() { return pairs_; }

 private:
  struct Moving {
    int vertex;
    double key;  // The key is the position along the line that sorts them.
    Vec3 x, y;   // The axes span the tangent plane.
    Vec3 saved_point, saved_normal;
    double saved_lift_mm;
    double wanted_lift_mm;
    bool is_lifted;  // True if the last apply_lift() lifted or lowered the vertex.
  };
  struct KnownGap {
    Vec3 center = Vec3::Zero();
    // The initial value means that the distance of the centre from the surface is still unknown.
    double distance_mm = 1e300;
  };
  struct Residual {
    double value, weight;
    std::array<int, 2> local;  // Moving vertices at the ends, −1 for a fixed one; the first is never −1.
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
  double way_mm_ = 0.0;       // The largest motions of the steps so far, added up.
  double overhang_mm_ = 0.0;  // Corners may overhang the border by this much because they are cut off.
  std::vector<int> local_;    // Maps a vertex to its index among the moving ones, or -1.
  std::vector<Moving> moving_;
  std::vector<int> triangles_, near_, changed_;
  std::vector<ModuleShape> saved_;    // These are the former shapes of triangles_.
  std::vector<KnownGap> known_gaps_;  // The centre of each triangle was last measured here.
  std::vector<char> is_local_;        // True if the triangle is in triangles_.
  std::vector<Pair> pairs_;
  std::vector<Residual> residuals_;
  std::vector<int> first_;
  EnvelopeSystem system_;
};

}  // namespace triskin::lattice

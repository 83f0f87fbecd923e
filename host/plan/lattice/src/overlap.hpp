// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "net.hpp"

namespace triskin::lattice {

/// Two circumradii; modules whose centroids are farther apart cannot touch.
inline constexpr double kApart_mm = 4.0 * kHeight_mm / 3.0;

/// Two triangles that may come to overlap, and the separating axis that was found last (0 … 5: sides of a, then of
/// b).
struct Pair {
  int a, b;
  bool in_fan;  ///< Both are joined to one triangle between them, so they hardly overlap while the joints hold.
  int axis = 0;
  double apart_until_mm = 0.0;  ///< The relaxer need not look at it before corners have moved this far in all.
};

/// Holds the depth by which two rigid modules overlap, and the motion that reduces it: corner `corner_a` of a against
/// corner `corner_b` of b along `axis` (unit): depth = axis · (a[corner_a] − b[corner_b]).
struct Overlap {
  double depth_mm = 0.0;
  Vec3 axis = Vec3::Zero();
  int corner_a = 0, corner_b = 0;
  /// If positive, the modules are at least this far apart, on two sides of a plane or by their distance.
  double apart_mm = 0.0;
};

/// Tests separating axes in the mean plane, as `penetration_depth` of map_modules.hpp defines the overlap up to 101.5°
/// between the normals; 0 beyond (body_overlap.hpp). Tries
/// `first_axis` first and leaves the separating one in it: neighbours that move little stay separated by the same axis.
[[nodiscard]] Overlap overlap_of(const NetTriangle& a, const NetTriangle& b, int& first_axis);
[[nodiscard]] Overlap overlap_of(const NetTriangle& a, const NetTriangle& b);

/// Returns true when two modules (corners in mm; less their corner cut), each shrunk by `allowed_mm` on all sides, pass
/// through each other in space, whichever way they face.
[[nodiscard]] bool pierced(const Triangle& a, const Triangle& b, double corner_cut_mm, double allowed_mm);

}  // namespace triskin::lattice

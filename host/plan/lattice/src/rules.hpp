// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "near_surface.hpp"
#include "net.hpp"
#include "overlap.hpp"
#include "triskin/design/design_types.hpp"
#include "triskin/mesh/surface.hpp"

namespace triskin::lattice {

/// Names the limit that refuses a module; kNone when all limits hold.
enum class Refusal {
  kNone,
  kEdgeError,
  kHingeGap,
  kFold,
  kCenterGap,
  kOutward,
  kPenetration,
  kOverrun,
  kLift,
  kDepth,
  kKeepOut
};
inline constexpr std::size_t kRefusals = 11;
[[nodiscard]] const char* name_of(Refusal refusal);

/// No module can have these corners.
inline const Triangle kNowhere{Vec3::Constant(1e300), Vec3::Constant(1e300), Vec3::Constant(1e300)};

/// The last measurement of a triangle's sides and their distance from a limit: they keep the limit until they move by
/// about as much.
struct KnownSides {
  Triangle rigid = kNowhere;
  double room_mm = 0.0;
};

/// Applies the limits to rigid modules. Immutable, so the chains share it.
class Rules {
 public:
  /// No module may cover one of `free_points`.
  Rules(const mesh::Surface& surface, const LayoutLimits& limits, const std::vector<Vec3>& free_points = {});

  [[nodiscard]] const LayoutLimits& limits() const { return limits_; }
  /// Returns the first limit that one of the triangles breaks, cheapest limits first. `pairs` must list all that may
  /// overlap and are not joined; `known`, by triangle, must not be shared between threads. Cost: about 1 µs per
  /// triangle, ten times that at the border.
  [[nodiscard]] Refusal evaluate(NearSurface& surface, const LatticeMesh& net, const std::vector<int>& triangles,
                                 std::vector<Pair>& pairs, std::vector<KnownSides>& known) const;

  /// Returns true if a side overhangs the border by more than is allowed, as the final measurement finds it: evaluate()
  /// only tests the border in steps. Cost: some 0.05 ms at the border, nothing far from it.
  [[nodiscard]] bool exceeds_overrun(NearSurface& surface, const NetTriangle& triangle) const;

 private:
  [[nodiscard]] Refusal evaluate_joints(const LatticeMesh& net, int triangle) const;
  [[nodiscard]] bool overlap(const NetTriangle& a, const NetTriangle& b, int& axis) const;
  [[nodiscard]] Refusal evaluate_sides(NearSurface& surface, const NetTriangle& triangle, KnownSides& known) const;
  [[nodiscard]] bool over_border(NearSurface& surface, const LatticeMesh& net, int triangle) const;
  [[nodiscard]] bool side_over_border(NearSurface& surface, const Vec3& from, const Vec3& to, double length_mm) const;
  [[nodiscard]] bool cut_sides_over_border(NearSurface& surface, const NetTriangle& triangle, std::size_t side,
                                           bool is_free) const;

  LayoutLimits limits_;  // The margin is already subtracted.
  double fold_cosine_;
  bool has_directed_folds_;
  std::vector<Vec3> probes_;  // These points lie just outside the border, and no module may cover them.
  PointGrid probe_grid_;
  std::vector<Vec3> free_points_;
  PointGrid free_grid_;
};

}  // namespace triskin::lattice

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <vector>

#include "net.hpp"
#include "triskin/geometry/module_layout.hpp"
#include "triskin/geometry/surface.hpp"

namespace triskin::geometry::surface_lattice {

/// What refuses a module; kNone when all limits hold.
enum class Refusal { kNone, kEdgeError, kHingeGap, kFold, kCenterGap, kOutward, kPenetration, kOverrun };
inline constexpr std::size_t kRefusals = 8;
[[nodiscard]] const char* name_of(Refusal refusal);

/// The limits, measured on rigid modules. Immutable: shared by the chains.
class Rules {
 public:
  Rules(const Surface& surface, const LayoutLimits& limits);

  [[nodiscard]] const LayoutLimits& limits() const { return limits_; }
  /// Cheapest limits first. Cost: 0.02 … 0.3 ms.
  [[nodiscard]] Refusal judge(const LatticeNet& net, int triangle) const;

 private:
  [[nodiscard]] Refusal judge_joints(const LatticeNet& net, int triangle) const;
  [[nodiscard]] bool overlaps(const LatticeNet& net, int triangle) const;
  [[nodiscard]] bool over_border(const LatticeNet& net, int triangle) const;
  [[nodiscard]] bool side_over_border(const Vec3& from, const Vec3& to) const;

  const Surface& surface_;
  LayoutLimits limits_;       // with the margin taken off
  std::vector<Vec3> probes_;  // points just outside the border: no module may cover one
};

}  // namespace triskin::geometry::surface_lattice

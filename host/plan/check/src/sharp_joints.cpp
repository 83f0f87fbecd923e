// SPDX-License-Identifier: GPL-3.0-or-later
// The bend of a joint on the board of a module, from the numbers of docs/fabrication.md and the taxels of the file.
#include <algorithm>
#include <cmath>
#include <functional>

#include "checked_design.hpp"

namespace triskin::check {
namespace {

// The board is 0.272 mm thick and bent over ten times that; the arc is measured in its middle.
constexpr double kThickness_mm = 0.272, kMiddleRadius_mm = 10.5 * kThickness_mm;
// Plated holes of 0.2 mm lie 1.85 mm from a side and stay 0.5 mm off the bend.
constexpr double kFreeOfHoles_mm = 1.85 - 0.1 - 0.5;
// The outermost track of a cable's pads lies 0.4 mm from the side and is 0.1 mm wide.
constexpr double kFreeOfCable_mm = 0.4 - 0.05;
constexpr double kPressureRadius_mm = 1.75, kTemperatureRadius_mm = 1.0;

// Returns how far the nearest pad or hole of a module is from its side `s`.
double free_beside(const CheckedDesign::Module& m, std::size_t s) {
  const P3 &a = m.corner[s], along = (m.corner[(s + 1) % 3] - a).normalized();
  double free_mm = kFreeOfHoles_mm;
  for (std::size_t t = 0; t < m.taxel.size(); ++t) {
    const double radius_mm = t == 6 || t == 10 ? kTemperatureRadius_mm : kPressureRadius_mm;
    free_mm = std::min(free_mm, (m.taxel[t] - a).cross(along).norm() - radius_mm);
  }
  return free_mm;
}

bool has_cable(const CheckedDesign::Module& m, std::size_t s) {
  return m.parent < 0 && m.rotation == static_cast<int>(s);
}

}  // namespace

std::vector<SharpJoint> sharp_joints_of(const CheckedDesign& d) {
  std::vector<SharpJoint> sharp;
  for (std::size_t k = 0; k < d.modules.size(); ++k) {
    const auto& m = d.modules[k];
    for (std::size_t s = 0; s < 3; ++s) {
      if (m.neighbour[s] <= static_cast<int>(k)) continue;
      const auto& o = d.modules[static_cast<std::size_t>(m.neighbour[s])];
      const int t = matching_side(m, static_cast<int>(s), o);
      if (t < 0) continue;  // The rule joint-lattice already reports this.
      const auto other_side = static_cast<std::size_t>(t);
      const P3 n = unit_normal(m.corner), other_n = unit_normal(o.corner);
      SharpJoint joint{{m.number, o.number}, std::atan2(n.cross(other_n).norm(), n.dot(other_n)), 0.0, false};
      joint.has_cable = has_cable(m, s) || has_cable(o, other_side);
      const double free_mm =
          joint.has_cable ? kFreeOfCable_mm : std::min(free_beside(m, s), free_beside(o, other_side));
      joint.limit_rad = 2.0 * free_mm / kMiddleRadius_mm;
      if (joint.bend_rad > joint.limit_rad) sharp.push_back(joint);
    }
  }
  std::ranges::stable_sort(sharp, std::greater{}, [](const SharpJoint& j) { return j.bend_rad - j.limit_rad; });
  return sharp;
}

}  // namespace triskin::check

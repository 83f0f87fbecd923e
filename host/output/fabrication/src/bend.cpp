// SPDX-License-Identifier: GPL-3.0-or-later
#include "bend.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "module_board.hpp"
#include "ring.hpp"
#include "triskin/base/error.hpp"
#include "triskin/design/module_number.hpp"

namespace triskin::fabrication {

using design::Vec2;

double module_bend_limit_rad() {
  double free_mm = design::kHeight_mm;
  for (const ModulePad& pad : module_pads()) {
    for (int side = 0; side < 3; ++side) {
      const Vec2 outward = rotated({0, -1}, 2.0 * std::numbers::pi / 3.0 * side);
      const double inset_mm = design::kHeight_mm / 3.0 - outward.dot(pad.at_mm);
      const double half_mm = pad.layer == PadLayer::kBack ? pad.size_mm.norm() / 2.0 : pad.size_mm.x() / 2.0;
      free_mm = std::min(free_mm, pad.layer == PadLayer::kThrough ? inset_mm - kContactHole_mm / 2.0 - kHoleToBend_mm
                                                                  : inset_mm - half_mm);
    }
  }
  return free_mm / bend_reach_mm(1.0);
}

double cable_bend_limit_rad() {
  constexpr double kSideFromMiddle_mm = design::kHeight_mm / 3.0;
  double free_mm = kSideFromMiddle_mm;
  for (std::size_t pin = 0; pin < kBusNets; ++pin) {
    for (const Vec2& p : cable_track(pin))
      free_mm = std::min(free_mm, p.y() + kSideFromMiddle_mm - kNarrowTrack_mm / 2.0);
  }
  return free_mm / bend_reach_mm(1.0);
}

void require_bends(const design::Design& design, const sheet::Sides& sides, const FlatIsland& island) {
  const double joint_limit_rad = module_bend_limit_rad(), cable_limit_rad = cable_bend_limit_rad();
  const auto has_cable = [&](const Fold& fold) {
    const auto at_side = [&](int id, int other) {
      return std::ranges::any_of(sides.of[static_cast<std::size_t>(id)], [&](const sheet::Side& side) {
        return side.other == other && (side.cable || side.jumper >= 0);
      });
    };
    return at_side(fold.module[0], fold.module[1]) || at_side(fold.module[1], fold.module[0]);
  };
  const Fold* worst = nullptr;
  double worst_excess_rad = 0.0, limit_rad = joint_limit_rad;
  int count = 0;
  for (const Fold& fold : island.folds) {
    const double allowed_rad = has_cable(fold) ? cable_limit_rad : joint_limit_rad;
    const double excess_rad = std::abs(fold.angle_rad) - allowed_rad;
    if (excess_rad <= 0.0) continue;
    ++count;
    if (excess_rad <= worst_excess_rad) continue;
    worst = &fold;
    worst_excess_rad = excess_rad;
    limit_rad = allowed_rad;
  }
  if (worst == nullptr) return;
  const auto degrees_of = [](double rad) { return std::abs(rad) * 180.0 / std::numbers::pi; };
  throw InputError(fmt::format(
      "island {}: the joint of modules {} and {} bends by {:.0f}°{}; a board of {:.2f} mm over a radius of {:.1f} mm "
      "allows {:.0f}° {}; make the design with --fold-rad {:.2f}",
      island.island, design::number_of(design, worst->module[0]), design::number_of(design, worst->module[1]),
      degrees_of(worst->angle_rad), count > 1 ? fmt::format(" ({} more are too sharp)", count - 1) : std::string(),
      kBoardThickness_mm, kBendRadius_mm, degrees_of(limit_rad),
      limit_rad == cable_limit_rad ? "where a cable is soldered" : "before holes and taxels lie in the bend",
      std::floor(100.0 * limit_rad) / 100.0));
}

}  // namespace triskin::fabrication

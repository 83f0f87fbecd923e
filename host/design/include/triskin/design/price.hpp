// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace triskin::design {

/// What the parts of a cover cost, in modules: the value of a layout is modules − price (docs/cost.md says why the
/// defaults are what they are). Each 0 … 16.
struct Price {
  double controller = 2.0;  ///< A controller with its cable costs as much as so many modules.
  double jumper = 0.35;     ///< A jumper, two connectors and the work of fitting it, costs as much as so many modules.
  double island = 0.1;      ///< An island is one more thing to place by hand.

  /// Price of a wired layout; all numbers ≥ 0. Constant cost.
  [[nodiscard]] constexpr double of(int controllers, int jumpers, int islands) const {
    return controller * controllers + jumper * jumpers + island * islands;
  }
};

}  // namespace triskin::design

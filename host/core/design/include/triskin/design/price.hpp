// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace triskin::design {

/// Costs of the parts of a cover, expressed in modules: the value of a layout is modules − price (docs/pipeline.md
/// explains the defaults). Each cost is 0 … 16.
struct Price {
  double controller = 2.0;  ///< The price includes the controller's cable.
  double jumper = 0.35;     ///< The price includes two connectors and the work of fitting them.
  double island = 0.1;      ///< Each island is one more object that a person must place by hand.

  /// Returns the price of a wired layout in modules; all arguments must be ≥ 0. Constant cost.
  [[nodiscard]] constexpr double of(int controllers, int jumpers, int islands) const {
    return controller * controllers + jumper * jumpers + island * islands;
  }
};

}  // namespace triskin::design

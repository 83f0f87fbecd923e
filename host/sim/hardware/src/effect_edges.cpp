// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>

#include "triskin/hardware/effects.hpp"

namespace triskin::hardware {

double rise_to_high_us(const EdgeEffect& effect, double capacitance_pf) {
  constexpr double kUsPerOhmPf = 1e-6;
  // A capacitor that is charged from 0 reaches 70 % of the supply, the lowest high level, after ln(1/0.3)·R·C.
  return std::log(1.0 / 0.3) * effect.pull_up_ohm * (capacitance_pf + effect.extra_pf) * kUsPerOhmPf;
}

}  // namespace triskin::hardware

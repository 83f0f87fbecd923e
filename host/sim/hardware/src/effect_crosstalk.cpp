// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/effects.hpp"

namespace triskin::hardware {

double crosstalk_counts(const CrosstalkEffect& effect, double own, double sum) {
  return effect.share * (sum - own);
}

}  // namespace triskin::hardware

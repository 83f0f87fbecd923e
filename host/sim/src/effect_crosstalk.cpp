// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/scene/effects.hpp"

namespace triskin::scene {

double crosstalk_counts(const CrosstalkEffect& effect, double own, double sum) {
  return effect.share * (sum - own);
}

}  // namespace triskin::scene

// SPDX-License-Identifier: GPL-3.0-or-later
#include "contact_count.hpp"

#include <algorithm>
#include <cmath>

namespace triskin::mechanics {

double count_threshold(double taxels) {
  const double wanted = std::log(std::max(1.0, taxels) / kFalseAlarm);
  // Solves t/2 = ln(1 + t/2) + wanted: the right side changes slowly, so a few rounds are enough.
  double half = wanted;
  for (int round = 0; round < 50; ++round) half = wanted + std::log1p(half);
  return 2.0 * half;
}

}  // namespace triskin::mechanics

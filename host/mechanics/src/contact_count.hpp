// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace triskin::mechanics {

/// The share of observations in which noise alone may pass for one more contact.
inline constexpr double kFalseAlarm = 1e-3;

/// What one more contact must take off the sum of squared, whitened residuals before it counts. A contact that is not
/// there explains noise with four parameters at any of `taxels` places, so the gain exceeds t with a probability of at
/// most taxels · P(χ²₄ > t) = taxels · (1 + t/2)·exp(−t/2) (Bonferroni); t is where that is kFalseAlarm.
[[nodiscard]] double count_threshold(double taxels);

}  // namespace triskin::mechanics

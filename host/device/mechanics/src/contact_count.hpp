// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace triskin::mechanics {

/// Noise alone may be taken for one more contact in this fraction of the observations.
inline constexpr double kFalseAlarm = 1e-3;

/// Returns how much one more contact must reduce the sum of squared, whitened residuals before it counts. A contact
/// that does not exist explains noise with four parameters at any of `taxels` places, so the gain exceeds t with a
/// probability of at most taxels · P(χ²₄ > t) = taxels · (1 + t/2)·exp(−t/2) (Bonferroni); t is where that is
/// kFalseAlarm.
[[nodiscard]] double count_threshold(double taxels);

}  // namespace triskin::mechanics

// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace triskin::layout {

/// Pressure of 1 kPa changes a taxel by about this many converter counts: 2.5 fF/kPa between 2 and 45 kPa (Maiolino et
/// al. 2013) at 16 pF in 65,536 counts. Skins differ with their dielectric, and `triskin calibrate` measures a real one
/// (docs/calibration.md).
inline constexpr double kCountsPerKpa = 10.0;
/// A sample scatters with this standard deviation: 0.70 … 0.78 of a byte of 4 counts in the recordings that Belli et
/// al. 2023 published.
inline constexpr double kNoise_counts = 3.0;
/// A taxel counts as pressed from this change on. At six deviations of the noise one sample in 10⁹ of an untouched
/// taxel is wrong, which is one in twenty minutes on a robot of 2,500 modules; the limit lies a little higher, at 2
/// kPa.
inline constexpr int kPressed_counts = 20;
static_assert(kPressed_counts > 6.0 * kNoise_counts);

}  // namespace triskin::layout

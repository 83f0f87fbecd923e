// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace triskin::mechanics {

/// 1 N/mm² is 1000 kPa: a pressure in kPa over mm² is a force in mN.
inline constexpr double kKpaMm2PerN = 1000.0;

/// Distance from the contact, in thicknesses of the layer, beyond which fields are zero. They fall by exp(−1 …
/// −2) a thickness.
inline constexpr double kFieldReach = 25.0;

}  // namespace triskin::mechanics

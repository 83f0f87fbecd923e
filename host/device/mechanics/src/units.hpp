// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace triskin::mechanics {

/// 1 N/mm² is 1000 kPa, so a pressure in kPa over mm² is a force in mN.
inline constexpr double kKpaMm2PerN = 1000.0;

/// Beyond this distance from the contact, in thicknesses, fields count as zero. They fall by exp(−1 … −2) per
/// thickness.
inline constexpr double kFieldReach = 25.0;

}  // namespace triskin::mechanics

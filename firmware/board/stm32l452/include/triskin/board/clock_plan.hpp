// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

#include "triskin/board/pll_setting.hpp"

/// Computes how the PLL makes the core's clock. No timer of this chip can measure the crystal, so the header of the
/// board states it. This is pure arithmetic, which the host tests.
namespace triskin::board {

/// The core, both buses, I²C and CAN have this clock, the highest one of the chip (voltage range 1).
inline constexpr std::uint32_t kSysclk_hz = 80'000'000;
/// The PLL's oscillator runs at this frequency; the core gets half of it.
inline constexpr std::uint32_t kVco_hz = 2 * kSysclk_hz;

/// The limits of the PLL are from the data sheet DS11912, PLL characteristics, and RM0394, RCC_PLLCFGR.
inline constexpr PllLimits kPllLimits{.min_input_hz = 4'000'000,
                                      .max_input_hz = 16'000'000,
                                      .min_vco_hz = 64'000'000,
                                      .max_vco_hz = 344'000'000,
                                      .max_divider = 8,
                                      .min_factor = 8,
                                      .max_factor = 86};

/// Returns the setting that makes kVco_hz from `source_hz`; empty if there is none.
[[nodiscard]] constexpr std::optional<PllSetting> pll_setting(std::uint32_t source_hz) {
  return pll_setting(source_hz, kVco_hz, kPllLimits);
}

}  // namespace triskin::board

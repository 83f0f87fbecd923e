// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "triskin/board/pll_setting.hpp"

/// Computes how the PLL makes the core's clock from the crystal that was found. This is pure arithmetic, which the host
/// tests.
namespace triskin::board {

/// The core, both buses, I²C and CAN have this clock. 160 MHz gives CAN FD equal time quanta in both phases.
inline constexpr std::uint32_t kSysclk_hz = 160'000'000;
/// The PLL's oscillator runs at this frequency; the core gets half of it.
inline constexpr std::uint32_t kVco_hz = 2 * kSysclk_hz;

/// The limits of the PLL are from the data sheet DS12288, PLL characteristics.
inline constexpr PllLimits kPllLimits{.min_input_hz = 2'660'000,
                                      .max_input_hz = 16'000'000,
                                      .min_vco_hz = 96'000'000,
                                      .max_vco_hz = 344'000'000,
                                      .max_divider = 16,
                                      .min_factor = 8,
                                      .max_factor = 127};

/// Returns the setting that makes kVco_hz from `source_hz`; empty if there is none.
[[nodiscard]] constexpr std::optional<PllSetting> pll_setting(std::uint32_t source_hz) {
  return pll_setting(source_hz, kVco_hz, kPllLimits);
}

/// Boards may carry one of these crystals. The closest two, 24 and 25 MHz, are 4 % apart.
inline constexpr std::array<std::uint32_t, 11> kCrystals_mhz{4, 5, 8, 10, 12, 16, 20, 24, 25, 32, 40};

/// Returns the crystal in Hz that matches a measurement against the internal oscillator. That oscillator is within 2 %
/// over the whole range of temperature (DS12288), so a crystal matches within 2 %. Empty: no crystal of the list, for
/// example one that oscillates at an overtone.
[[nodiscard]] constexpr std::optional<std::uint32_t> crystal_near(std::uint32_t measured_hz) {
  constexpr std::uint32_t kMaxErrorPercent = 2;
  for (const std::uint32_t mhz : kCrystals_mhz) {
    const std::uint32_t hz = mhz * 1'000'000, error_hz = measured_hz > hz ? measured_hz - hz : hz - measured_hz;
    if (error_hz <= hz / 100 * kMaxErrorPercent) return hz;
  }
  return std::nullopt;
}

/// Returns true if every crystal of the list has a setting.
[[nodiscard]] consteval bool all_crystals_have_settings() {
  for (const std::uint32_t mhz : kCrystals_mhz) {
    if (!pll_setting(mhz * 1'000'000)) return false;
  }
  return true;
}
static_assert(all_crystals_have_settings());

}  // namespace triskin::board

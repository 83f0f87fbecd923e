// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>

/// Computes how the PLL makes the core's clock from the crystal that was found. This is pure arithmetic, which the host
/// tests.
namespace triskin::board {

/// The core, both buses, I²C and CAN have this clock. 160 MHz gives CAN FD equal time quanta in both phases.
inline constexpr std::uint32_t kSysclk_hz = 160'000'000;
/// The PLL's oscillator runs at this frequency; the core gets half of it.
inline constexpr std::uint32_t kVco_hz = 2 * kSysclk_hz;

/// The limits of the PLL are from the data sheet DS12288, PLL characteristics.
namespace pll_limits {
inline constexpr std::uint32_t kMinInput_hz = 2'660'000, kMaxInput_hz = 16'000'000, kMinVco_hz = 96'000'000,
                               kMaxVco_hz = 344'000'000, kMaxDivider = 16, kMinFactor = 8, kMaxFactor = 127;
}  // namespace pll_limits
static_assert(kVco_hz >= pll_limits::kMinVco_hz && kVco_hz <= pll_limits::kMaxVco_hz);

/// The PLL multiplies its input by `factor` after dividing it by `divider`.
struct PllSetting {
  std::uint32_t divider = 0, factor = 0;
  bool operator==(const PllSetting&) const = default;
};

/// Returns the setting that makes exactly kVco_hz from `source_hz`, with the fastest input that the PLL's limits allow
/// (the least jitter); empty if there is none.
[[nodiscard]] constexpr std::optional<PllSetting> pll_setting(std::uint32_t source_hz) {
  using namespace pll_limits;
  for (std::uint32_t divider = 1; divider <= kMaxDivider; ++divider) {
    if (source_hz % divider != 0) continue;
    const std::uint32_t input_hz = source_hz / divider;
    if (input_hz < kMinInput_hz || input_hz > kMaxInput_hz || kVco_hz % input_hz != 0) continue;
    const std::uint32_t factor = kVco_hz / input_hz;
    if (factor >= kMinFactor && factor <= kMaxFactor) return PllSetting{divider, factor};
  }
  return std::nullopt;
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

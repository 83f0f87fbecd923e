// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>

/// Computes how a PLL makes its oscillator's frequency. This is pure arithmetic, which the host tests.
namespace triskin::board {

/// The data sheet of a chip gives these limits of its PLL.
struct PllLimits {
  std::uint32_t min_input_hz, max_input_hz, min_vco_hz, max_vco_hz, max_divider, min_factor, max_factor;
};

/// The PLL multiplies its input by `factor` after dividing it by `divider`.
struct PllSetting {
  std::uint32_t divider = 0, factor = 0;
  bool operator==(const PllSetting&) const = default;
};

/// The internal oscillator may be off by so much over the whole range of temperature (DS12288, DS11912: 1.5 … 2 %).
inline constexpr std::uint32_t kSourceErrorPercent = 2;

/// Returns the setting that makes exactly `vco_hz` from `source_hz`, with the fastest input that the limits allow (the
/// least jitter) with a source that is off by kSourceErrorPercent; empty if there is none.
[[nodiscard]] constexpr std::optional<PllSetting> pll_setting(std::uint32_t source_hz, std::uint32_t vco_hz,
                                                              const PllLimits& limits) {
  const auto within = [](std::uint32_t hz, std::uint32_t min_hz, std::uint32_t max_hz) {
    return hz / 100 * (100 - kSourceErrorPercent) >= min_hz && hz / 100 * (100 + kSourceErrorPercent) <= max_hz;
  };
  if (!within(vco_hz, limits.min_vco_hz, limits.max_vco_hz)) return std::nullopt;
  for (std::uint32_t divider = 1; divider <= limits.max_divider; ++divider) {
    if (source_hz % divider != 0) continue;
    const std::uint32_t input_hz = source_hz / divider;
    if (!within(input_hz, limits.min_input_hz, limits.max_input_hz) || vco_hz % input_hz != 0) continue;
    const std::uint32_t factor = vco_hz / input_hz;
    if (factor >= limits.min_factor && factor <= limits.max_factor) return PllSetting{divider, factor};
  }
  return std::nullopt;
}

}  // namespace triskin::board

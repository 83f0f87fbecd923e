// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <expected>

#include "triskin/board/clock_plan.hpp"
#include "triskin/core/status.hpp"

namespace triskin::board {

/// The limits are those of fast mode in UM10204 (table 10) and of the pins' analog filter (data sheet DS12288, I²C
/// characteristics).
namespace i2c_limits {
inline constexpr std::uint64_t kLow_ns = 1300, kHigh_ns = 600, kSetup_ns = 100, kDataValid_ns = 900;
inline constexpr std::uint64_t kFilterMin_ns = 50, kFilterMax_ns = 260;
}  // namespace i2c_limits

/// The timing depends on these limits of the wires and the clock. All times are in ns.
struct I2cTimingInput {
  std::uint32_t kernel_hz = kSysclk_hz;  ///< The I²C block has this clock.
  std::uint32_t bus_hz = 400'000;        ///< The bus should run at this speed, at most 400 kHz.
  std::uint32_t rise_ns = 300;           ///< The line rises within this time.
  std::uint32_t fall_ns = 300;           ///< The line falls within this time, and data are held for as long.
};

/// RM0440 §39.9.5 defines the fields of I2C_TIMINGR; the other members are the resulting times.
struct I2cTiming {
  std::uint8_t prescaler = 0, data_delay = 0, data_setup = 0, high = 0, low = 0;
  std::uint32_t low_ns = 0, high_ns = 0, period_ns = 0;
  /// Returns the register I2C_TIMINGR with these fields.
  [[nodiscard]] constexpr std::uint32_t value() const {
    return static_cast<std::uint32_t>(prescaler) << 28 | static_cast<std::uint32_t>(data_setup) << 20 |
           static_cast<std::uint32_t>(data_delay) << 16 | static_cast<std::uint32_t>(high) << 8 | low;
  }
};

/// Computes fast mode (UM10204 table 10): SCL low ≥ 1300 ns, high ≥ 600 ns, data set up ≥ 100 ns, data valid ≤
/// 900 ns. SCL's period also includes the synchronization of both edges: analog filter 50 … 260 ns and two to three
/// kernel clocks each (§39.4.10); the shortest of these counts, so that the bus never exceeds bus_hz. It tries
/// prescalers from the finest. Errors: kOutOfRange when the clock cannot produce it, or bus_hz is 0 or above 400 kHz.
[[nodiscard]] constexpr Result<I2cTiming> compute_i2c_timing(const I2cTimingInput& in) {
  using namespace i2c_limits;
  if (in.bus_hz == 0 || in.bus_hz > 400'000 || in.kernel_hz < 8'000'000) return std::unexpected(Status::kOutOfRange);
  const std::uint64_t period_ps = 1'000'000'000'000ULL / in.bus_hz;
  const std::uint64_t clock_ps = 1'000'000'000'000ULL / in.kernel_hz;
  const std::uint64_t sync_ps = 2 * (kFilterMin_ns * 1000 + 2 * clock_ps);  // Both edges take at least this long.
  for (std::uint64_t p = 0; p < 16; ++p) {
    const std::uint64_t unit_ps = (p + 1) * clock_ps;
    const auto units = [unit_ps](std::uint64_t ps) { return (ps + unit_ps - 1) / unit_ps; };
    const std::uint64_t total = units(period_ps > sync_ps ? period_ps - sync_ps : 0);
    std::uint64_t low = units(kLow_ns * 1000), high = units(kHigh_ns * 1000);
    if (total > low + high) {  // The spare time is divided in the ratio of the limits.
      const std::uint64_t spare = total - low - high;
      low += spare - spare / 3;
      high += spare / 3;
    }
    const std::uint64_t setup = units((in.rise_ns + kSetup_ns) * 1000);
    // Data must be held longer than the fall that the filter may hide, but not so long that they become valid too late
    // (§39.4.5).
    const std::uint64_t hidden_ps = kFilterMin_ns * 1000 + 3 * clock_ps;
    const std::uint64_t hold = in.fall_ns * 1000 > hidden_ps ? units(in.fall_ns * 1000 - hidden_ps) : 0;
    const std::uint64_t latest_ps = hold * unit_ps + kFilterMax_ns * 1000 + 4 * clock_ps + in.rise_ns * 1000;
    if (low > 256 || high > 256 || setup > 16 || hold > 15 || latest_ps > kDataValid_ns * 1000) continue;
    I2cTiming t;
    t.prescaler = static_cast<std::uint8_t>(p);
    t.low = static_cast<std::uint8_t>(low - 1);
    t.high = static_cast<std::uint8_t>(high - 1);
    t.data_setup = static_cast<std::uint8_t>(setup - 1);
    t.data_delay = static_cast<std::uint8_t>(hold);
    t.low_ns = static_cast<std::uint32_t>(low * unit_ps / 1000);
    t.high_ns = static_cast<std::uint32_t>(high * unit_ps / 1000);
    t.period_ns = static_cast<std::uint32_t>(((low + high) * unit_ps + sync_ps) / 1000);
    return t;
  }
  return std::unexpected(Status::kOutOfRange);
}

}  // namespace triskin::board

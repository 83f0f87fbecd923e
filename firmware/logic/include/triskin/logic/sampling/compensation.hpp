// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/layout/module.hpp"
#include "triskin/layout/taxel_signal.hpp"

namespace triskin::fw {

/// Removes everything that is not a touch from one module's readings, in fixed point: out = 0x8000 + (raw − baseline)
/// − gain · (pads − pads at the baseline), limited to 0 … 65535. Pads are layout::kTemperaturePads, which feel
/// temperature but no finger; their own output is their change since the baseline. If a taxel moves by less than
/// `kTouch` counts, its baseline follows with a time constant of 2^kFollow samples, which removes drift that the pads
/// do not explain. Readings in which a taxel is invalid do not affect it. The error compared to real numbers is below 1
/// count of the output (tests/firmware/compensation_test.cpp).
class Compensation {
 public:
  using Taxels = std::array<std::uint16_t, layout::kTaxelsPerModule>;
  static constexpr const auto& kPads = layout::kTemperaturePads;
  static constexpr unsigned kFraction = 16;  ///< A baseline has this many fractional bits.
  static constexpr unsigned kGainBits = 14;  ///< A gain has this many fractional bits: 1 << 14 is 1.
  static constexpr unsigned kFollow = 10;
  /// Changes below this many counts are drift and not a touch.
  static constexpr std::int32_t kTouch = layout::kPressed_counts;
  static constexpr std::int32_t kRest = 0x8000;

  /// Makes the next reading the baseline.
  void restart() {
    started_ = false;
    ++restarts_;
  }
  /// Counts the calls of restart(), modulo 256; callers that store a rest value compare it.
  [[nodiscard]] std::uint8_t restarts() const { return restarts_; }
  /// Sets how much of the pads' change a taxel shows, −2 … 2 in units of 2^-kGainBits; it is 1 at first.
  void set_gain(std::size_t taxel, std::int16_t gain) { gain_[taxel] = gain; }
  /// Adds one reading; bit t of `valid` belongs to taxel t. Cost: about 20 instructions per taxel.
  void add(const Taxels& raw, std::uint16_t valid);

  /// Returns the compensated value of each taxel in counts; 0x8000 at rest.
  [[nodiscard]] const Taxels& output() const { return output_; }
  /// Returns the change of taxel t (0..11) from its baseline in counts.
  [[nodiscard]] int change(std::size_t taxel) const { return static_cast<int>(output_[taxel]) - kRest; }

 private:
  static constexpr std::array<std::int16_t, layout::kTaxelsPerModule> unity() {
    std::array<std::int16_t, layout::kTaxelsPerModule> g{};
    g.fill(1 << kGainBits);
    return g;
  }
  [[nodiscard]] std::int64_t pads_change(const Taxels& raw, std::uint16_t valid) const;

  std::array<std::int64_t, layout::kTaxelsPerModule> baseline_{};  // The unit is counts · 2^kFraction.
  std::array<std::int16_t, layout::kTaxelsPerModule> gain_ = unity();
  std::array<std::uint16_t, kPads.size()> pad_baseline_{};
  std::uint16_t known_ = 0;  // Bit t says that taxel t has a baseline.
  Taxels output_{};
  bool started_ = false;
  std::uint8_t restarts_ = 0;
};

}  // namespace triskin::fw

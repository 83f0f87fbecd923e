// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/layout/module.hpp"

namespace triskin::fw {

/// Takes what is no touch out of one module's readings, in fixed point:
///   out = 0x8000 + (raw − baseline) − gain · (pads − pads at the baseline), held inside 0 … 65535.
/// Pads are layout::kTemperaturePads, which feel the temperature but no finger; their own output is their change since
/// the baseline. Where a taxel moves by less than `kTouch` counts, its baseline follows with a time constant of
/// 2^kFollow samples: what the pads do not explain. Readings in which a taxel is not valid leave it as it is. Error
/// against the same in real numbers: below 1 count of the output (tests/firmware/compensation_test.cpp).
class Compensation {
 public:
  using Taxels = std::array<std::uint16_t, layout::kTaxelsPerModule>;
  static constexpr const auto& kPads = layout::kTemperaturePads;
  static constexpr unsigned kFraction = 16;  ///< fractional bits of a baseline
  static constexpr unsigned kGainBits = 14;  ///< fractional bits of a gain: 1 << 14 is 1
  static constexpr unsigned kFollow = 10;
  static constexpr std::int32_t kTouch = 100;  ///< counts
  static constexpr std::int32_t kRest = 0x8000;

  /// The next reading becomes the baseline.
  void restart() {
    started_ = false;
    ++restarts_;
  }
  /// Counts restart(), from 0 again after 255: who keeps a value at rest of his own compares it.
  [[nodiscard]] std::uint8_t restarts() const { return restarts_; }
  /// How much of the pads' change a taxel shows, −2 … 2 in units of 2^-kGainBits; 1 at first.
  void set_gain(std::size_t taxel, std::int16_t gain) { gain_[taxel] = gain; }
  /// One reading; `valid` has a bit a taxel. Cost: about 20 instructions a taxel.
  void add(const Taxels& raw, std::uint16_t valid);

  /// Compensated value of each taxel, counts; 0x8000 at rest.
  [[nodiscard]] const Taxels& output() const { return output_; }
  /// Change of taxel t (0..11) from its baseline, counts.
  [[nodiscard]] int change(std::size_t taxel) const { return static_cast<int>(output_[taxel]) - kRest; }

 private:
  static constexpr std::array<std::int16_t, layout::kTaxelsPerModule> unity() {
    std::array<std::int16_t, layout::kTaxelsPerModule> g{};
    g.fill(1 << kGainBits);
    return g;
  }
  [[nodiscard]] std::int64_t pads_change(const Taxels& raw, std::uint16_t valid) const;

  std::array<std::int64_t, layout::kTaxelsPerModule> baseline_{};  // Unit: counts · 2^kFraction.
  std::array<std::int16_t, layout::kTaxelsPerModule> gain_ = unity();
  std::array<std::uint16_t, kPads.size()> pad_baseline_{};
  std::uint16_t known_ = 0;  // Bit t: taxel t has a baseline.
  Taxels output_{};
  bool started_ = false;
  std::uint8_t restarts_ = 0;
};

}  // namespace triskin::fw

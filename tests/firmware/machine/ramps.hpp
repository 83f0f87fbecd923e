// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cmath>

#include "sampling_bench.hpp"

namespace triskin::machine {

/// The data sheet allows oscillators to be off by ± 4 %; each module has another error in this range.
inline constexpr std::array<int, 16> kClock_ppm{-40'000, 40'000,  0,   12'000,  -3'000, 25'000, -31'000, 7'000,
                                                39'000,  -15'000, 500, -39'500, 18'000, -500,   33'000,  -22'000};

/// Gives each module its own clock, and a ramp by which a value tells when it was converted.
class Ramps : public Sampling {
 protected:
  void spread_clocks(double part) {
    for (int m = 0; m < layout::kMaxModules; ++m) {
      module_at(m).chip->set_clock_error(static_cast<int>(part * kClock_ppm[static_cast<std::size_t>(m)]));
      module_at(m).source.ramp = true;
    }
  }
  // Returns when taxel `t` of module `m` was converted, in steps of the ramp; modulo its length.
  int converted(int m, std::size_t t, const wire::TaxelFrame& f) {
    const auto afe = module_at(m).chip->read_register(static_cast<std::uint16_t>(0x082 + 8 * t), 0) & 0x3F;
    const auto level =
        static_cast<int>(std::lround(module_at(m).source.level[t] - afe * module_at(m).behaviour.step_counts));
    return (f.value[t] - 0x8000 + level + 16 * PadSource::kRampCounts) % PadSource::kRampCounts;
  }
  static int gap(int later, int earlier) {
    constexpr int kHalf = PadSource::kRampCounts / 2;
    return (later - earlier + kHalf + PadSource::kRampCounts) % PadSource::kRampCounts - kHalf;
  }

  static constexpr double kNoise = 3.0;  // The noise of the converter and one count of rounding add up to this.
  double stage_of(int m) { return static_cast<double>(module_at(m).chip->sequence_us()) / 12.0 / PadSource::kRamp_us; }
  // Expects all twelve taxels to come from one sequence.
  void expect_not_torn(int m, const wire::TaxelFrame& f) {
    ASSERT_EQ(f.valid, layout::kAllTaxels) << "module " << m;
    for (std::size_t t = 1; t < layout::kTaxelsPerModule; ++t) {
      ASSERT_NEAR(gap(converted(m, t, f), converted(m, 0, f)), static_cast<double>(t) * stage_of(m), kNoise + 9)
          << "torn: module " << m << " sample " << f.sample;
    }
  }

  // Expects every sequence once, with all twelve taxels from the same one.
  void expect_whole(int m, const std::vector<wire::TaxelFrame>& list) {
    const double stage = stage_of(m);
    for (std::size_t k = 0; k < list.size(); ++k) {
      expect_not_torn(m, list[k]);
      if (k == 0) continue;
      ASSERT_EQ(list[k].sample, list[k - 1].sample + 1)
          << "lost: module " << m << ", sample " << k << " of " << list.size();
      // A sequence that was restarted arrives later, never earlier.
      const double passed = gap(converted(m, 0, list[k]), converted(m, 0, list[k - 1]));
      ASSERT_GE(passed, 12 * stage - kNoise - 9) << "repeated: module " << m << " sample " << list[k].sample;
      ASSERT_LE(passed, 24 * stage - kNoise) << "left out: module " << m << " sample " << list[k].sample;
    }
  }
};

}  // namespace triskin::machine

// SPDX-License-Identifier: GPL-3.0-or-later
// Compares reading by a timer, as installed iCub boards do, with reading in the window: torn samples and bus time.
#include <numeric>

#include "ramps.hpp"

namespace triskin::machine {
namespace {

struct Comparison {
  std::string_view chip;
  wire::SamplingTiming timing;
  double min_torn, max_torn;  ///< These are fractions of the samples.
};

class ReadingTiming : public Ramps, public ::testing::WithParamInterface<Comparison> {
 protected:
  [[nodiscard]] bool is_torn(int m, const wire::TaxelFrame& f) {
    for (std::size_t t = 1; t < layout::kTaxelsPerModule; ++t) {
      const double expected = static_cast<double>(t) * stage_of(m);
      if (std::abs(gap(converted(m, t, f), converted(m, 0, f)) - expected) > kNoise + 9) return true;
    }
    return false;
  }
  // Returns true if the first taxel comes from the same conversion as the one before.
  [[nodiscard]] bool is_repeated(int m, const wire::TaxelFrame& f, const wire::TaxelFrame& before) {
    return gap(converted(m, 0, f), converted(m, 0, before)) < 6 * stage_of(m);
  }
  [[nodiscard]] std::uint64_t bus_us() const {
    const auto& busy = machine->counts().i2c_busy_us;
    return std::accumulate(busy.begin(), busy.end(), std::uint64_t{0});
  }
};

TEST_P(ReadingTiming, TornSamplesAndBusTime) {
  const Comparison& c = GetParam();
  behave(behaviour_named(c.chip));
  spread_clocks(1.0);
  start(16, {wire::Decimation::k64, 1, wire::TaxelOutput::kRaw, c.timing});
  run_for(500'000);
  frames.clear();
  const std::uint64_t bus_before = bus_us();
  constexpr std::uint64_t kRun_us = 3'000'000;
  run_for(kRun_us);
  std::size_t all = 0, torn = 0, repeated = 0;
  for (const auto& [m, list] : samples()) {
    for (std::size_t k = 0; k < list.size(); ++k) {
      ++all;
      torn += is_torn(m, list[k]) ? 1 : 0;
      repeated += k > 0 && is_repeated(m, list[k], list[k - 1]) ? 1 : 0;
    }
  }
  const double per_module = static_cast<double>(all) / 16 / 3,
               share = static_cast<double>(torn) / static_cast<double>(all);
  const double busy = static_cast<double>(bus_us() - bus_before) / 4 / static_cast<double>(kRun_us);
  std::printf("%s, %s: %.1f samples/s of a module, torn %.1f %%, first taxel repeated %.1f %%, line busy %.1f %%\n",
              std::string(c.chip).c_str(), c.timing == wire::SamplingTiming::kTimer ? "timer" : "tracked", per_module,
              100 * share, 100.0 * static_cast<double>(repeated) / static_cast<double>(all), 100 * busy);
  EXPECT_GE(share, c.min_torn);
  EXPECT_LE(share, c.max_torn);
  EXPECT_NEAR(per_module, 1e6 / 9'200, 3.0);
  if (c.timing == wire::SamplingTiming::kTracked) {
    EXPECT_EQ(repeated, 0U);
  }
  expect_no_violation();
}

// A burst lasts some 640 of 9,200 us. A converter that shows its results stage by stage is torn at any moment but the
// end of its sequence, so by far most samples are torn. One that shows them at the end of the sequence is torn only
// while it is read: 640 / 9,200 = 7 %, between 3 and 14 because phases of sixteen chips in three seconds are not spread
// evenly.
INSTANTIATE_TEST_SUITE_P(Chips, ReadingTiming,
                         ::testing::Values(Comparison{"ConvReset", wire::SamplingTiming::kTracked, 0, 0},
                                           Comparison{"ConvReset", wire::SamplingTiming::kTimer, 0.5, 1},
                                           Comparison{"AllAtOnce", wire::SamplingTiming::kTracked, 0, 0},
                                           Comparison{"AllAtOnce", wire::SamplingTiming::kTimer, 0.03, 0.14}),
                         [](const auto& tested) {
                           return std::string(tested.param.chip) +
                                  (tested.param.timing == wire::SamplingTiming::kTimer ? "Timer" : "Tracked");
                         });

}  // namespace
}  // namespace triskin::machine

// SPDX-License-Identifier: GPL-3.0-or-later
// Measures sample rate against noise: tools/make_noise_table writes the table of docs/firmware.md from this
// output.
#include <algorithm>
#include <cmath>

#include "sampling_bench.hpp"

namespace triskin::machine {
namespace {

struct Measured {
  double samples_per_s = 0, rms_counts = 0;
  int peak_to_peak_counts = 0;
};

class Noise : public Sampling {
 protected:
  // Measures sixteen modules that nobody touches.
  Measured measure(wire::Decimation decimation) {
    start(16, {decimation, 1});
    constexpr std::uint64_t kRun_us = 3'000'000;
    run_for(kRun_us);
    Measured out;
    double squares = 0;
    std::size_t count = 0;
    for (const auto& [m, list] : samples()) {
      out.samples_per_s += static_cast<double>(list.size()) / (kRun_us * 1e-6) / 16;
      for (std::size_t t = 0; t < layout::kTaxelsPerModule; ++t) {
        double mean = 0;
        for (const auto& f : list) mean += f.value[t] / static_cast<double>(list.size());
        for (const auto& f : list) squares += (f.value[t] - mean) * (f.value[t] - mean);
        count += list.size() - 1;
        const auto [low, high] = std::ranges::minmax(list, {}, [t](const wire::TaxelFrame& f) { return f.value[t]; });
        out.peak_to_peak_counts = std::max(out.peak_to_peak_counts, high.value[t] - low.value[t]);
      }
    }
    out.rms_counts = std::sqrt(squares / static_cast<double>(count));
    return out;
  }
};

// The AD7147 data sheet states 3, 7 and 12 codes peak to peak at 256, 128 and 64; 36.9, 18.4 and 9.2 ms for twelve
// stages.
TEST_F(Noise, FallsAsTheRateDoes) {
  struct Row {
    wire::Decimation decimation;
    int factor;
    double sequence_ms, peak_to_peak;
  };
  for (const Row& row : {Row{wire::Decimation::k64, 64, 9.2, 12}, Row{wire::Decimation::k128, 128, 18.4, 7},
                         Row{wire::Decimation::k256, 256, 36.9, 3}}) {
    const Measured m = measure(row.decimation);
    EXPECT_NEAR(m.samples_per_s, 1000 / row.sequence_ms, 0.02 * 1000 / row.sequence_ms);
    EXPECT_LE(m.peak_to_peak_counts, row.peak_to_peak + 1);
    EXPECT_NEAR(m.rms_counts, std::sqrt(std::pow(row.peak_to_peak / 6.6, 2) + 1.0 / 12),
                0.15 * row.peak_to_peak / 6.6 + 0.05);  // The second term is for rounding.
    std::printf("| %d | %.1f | %.1f | %.2f | %d |\n", row.factor, row.sequence_ms, m.samples_per_s, m.rms_counts,
                m.peak_to_peak_counts);
  }
  expect_no_violation();
}

}  // namespace
}  // namespace triskin::machine

// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/drivers/ad7147.hpp"
#include "triskin/logic/sampling/sequence_clock.hpp"
#include "triskin/wire/offsets.hpp"

namespace triskin::fw {

/// Finds out when a chip shows its results, which the data sheet leaves open: each at the end of its stage, or all at
/// the end of the sequence. A chip whose offsets changed between two restarts of its sequence is read in mid-sequence:
/// the results of the first stages then have either the new offsets or still the old ones. It makes no transfers: it
/// receives results and gives a verdict.
class LatchProbe {
 public:
  /// The probe may begin after this percentage of the nominal sequence.
  static constexpr std::uint32_t kBegin_percent = 55;
  /// At this percentage the fastest oscillator ends the sequence.
  static constexpr std::uint32_t kEnd_percent = 100 - SequenceClock::kTolerance_percent;
  static constexpr int kStages = Ad7147::kOffsetStages;  ///< These first stages have ended by then.
  static_assert(kStages * (100 + SequenceClock::kTolerance_percent) / ad7147::kStages < kBegin_percent);
  static constexpr int kMaxProbes = 3;

  /// Discards everything that is known about the chip.
  void forget() { *this = {}; }
  /// Returns what is known about the chip.
  [[nodiscard]] wire::Latching latching() const { return latching_; }
  /// Returns true if a probe would help.
  [[nodiscard]] bool wanted() const { return latching_ == wire::Latching::kUnknown; }
  /// Stores `results` that were read in mid-sequence.
  void store(const ad7147::Results& results);
  /// Notes that the sequence ended without a reading in its middle, or that another one begins.
  void skip() { probed_ = false; }
  /// Compares with the results before the change of the configuration and at the end of the sequence. After kMaxProbes
  /// without a verdict, the chip is assumed to show each result at the end of its stage.
  void compare(const ad7147::Results& before, const ad7147::Results& after);

 private:
  ad7147::Results middle_{};
  std::uint8_t probes_ = 0;
  bool probed_ = false;
  wire::Latching latching_ = wire::Latching::kUnknown;
};

}  // namespace triskin::fw

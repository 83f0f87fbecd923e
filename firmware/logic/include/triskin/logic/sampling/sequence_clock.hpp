// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/wire/offsets.hpp"

namespace triskin::fw {

/// Predicts when one converter's sequence of twelve stages ends. The chip has its own oscillator and signals no end.
/// The class stores what is certain: an interval in which the present sequence ends, and one in which the period lies.
/// It begins with the moment at which the sequence was started. A reading of the stage-complete status shows whether a
/// stage had ended at a time and narrows the first interval; comparison with an earlier end narrows the second. All
/// stages last equally long, so any of them will do. Time is an argument.
///
/// A burst of twelve results is consistent when the last result is read after the end of the sequence and the first one
/// before stage 0 of the next is complete, wherever in the interval the end is: that is the window of read_us() …
/// last_start_us(). A chip that shows all results at the end of the sequence is read consistently when the first result
/// is read after that end and the last one before the next. While the kind of a chip is unknown, the second window
/// applies: its results may then be of two sequences, but none is from before the start.
class SequenceClock {
 public:
  /// The oscillator may be off by this until the first end is measured. Its limits are not in any source at hand (±4 %
  /// are typical); three times that is assumed.
  static constexpr std::uint32_t kTolerance_percent = 12;
  /// The first result of a burst is read this long after its start, after six bytes.
  static constexpr std::uint64_t kFirstResult_us = 135;
  /// The high byte of the last result of a burst is read this long after its start, after 26 bytes.
  static constexpr std::uint64_t kLastResult_us = 585;
  static constexpr int kStages = 12;

  /// Notes that the sequence was restarted at `at_us`; the oscillator is only known to ± `tolerance_percent`. While
  /// that is more than 4, there is no window for a chip that shows its results stage by stage: its first sequence can
  /// only be read once the status has narrowed its end.
  void start(std::uint64_t at_us, std::uint32_t nominal_us, wire::Latching latching = wire::Latching::kEachStage,
             std::uint32_t tolerance_percent = kTolerance_percent);
  /// Sets when the chip shows its results, which was found out since the start.
  void set_latching(wire::Latching latching) { latching_ = latching; }
  /// Notes that the sequence was restarted at `at_us` on a chip whose oscillator is already known, unless the status
  /// contradicted that.
  void restart(std::uint64_t at_us);

  /// Returns the middle of the interval in which the present sequence ends.
  [[nodiscard]] std::uint64_t end_us() const { return (first_ + last_) / 2 >> kFraction; }
  [[nodiscard]] std::uint64_t period_us() const { return (shortest_ + longest_) / 2 >> kFraction; }
  /// Returns the length of the interval in which the present sequence ends.
  [[nodiscard]] std::uint64_t doubt_us() const { return (last_ - first_) >> kFraction; }
  /// Returns how many sequences, 1 to `most`, may pass without a refinement, because the period is known that well.
  [[nodiscard]] std::uint32_t may_pass(std::uint32_t most) const;
  /// The burst for the present sequence may start between read_us() and last_start_us().
  [[nodiscard]] std::uint64_t read_us() const {
    return (last_ >> kFraction) + kMargin_us - (stage_by_stage() ? kLastResult_us : kFirstResult_us);
  }
  [[nodiscard]] std::uint64_t last_start_us() const {
    return (first_ >> kFraction) + (stage_by_stage() ? stage_us() - kFirstResult_us : sequence_us() - kLastResult_us) -
           kMargin_us;
  }

  /// Returns true if the end of the present sequence is not known well enough.
  [[nodiscard]] bool refinement_wanted() const { return doubt_us() > kWanted_us; }
  /// Returns a time at which the sequence before the present one has certainly ended.
  [[nodiscard]] std::uint64_t began_us() const {
    return (since_anchor_ == 1 ? anchor_last_ : last_ - shortest_) >> kFraction;
  }
  /// Returns the best estimate of when `stage` (0..11) of the present sequence ends; reading the status at that time
  /// tells most.
  [[nodiscard]] std::uint64_t stage_end_us(int stage) const;
  /// Returns the length of the interval in which that stage ends. In the first sequence after a start the early stages
  /// are known best.
  [[nodiscard]] std::uint64_t stage_doubt_us(int stage) const;
  /// Narrows the intervals: the status, sampled at `at_us`, showed whether `stage` of the present sequence had `ended`.
  void refine(std::uint64_t at_us, int stage, bool ended);
  /// Advances to the sequence after the present one, `count` times.
  void next(std::uint32_t count = 1);
  /// Returns true if the status repeatedly contradicted what was known, or there was no time to read it, so that
  /// restarting the sequence gives more than a refinement.
  [[nodiscard]] bool uncertain() const;

 private:
  static constexpr unsigned kFraction = 16;        // A microsecond has this many fractional bits.
  static constexpr std::uint64_t kMargin_us = 25;  // The first and last burst keep this margin.
  // The measured time of a start, or of a reading of the status, may be wrong by this.
  static constexpr std::uint64_t kSlack = 25ULL << kFraction;
  static constexpr std::uint64_t kWanted_us = 120, kMaxGrowth_us = 300;
  static constexpr std::uint64_t kWander_ppm_per_s = 80;  // An oscillator that warms up drifts by at most this.
  static constexpr std::uint32_t kAnchorFor = 64;         // The period is measured over this many sequences.
  static constexpr int kMaxContradictions = 4;

  // The result has 32 bits, because the loop reads it all the time and the core cannot divide wider numbers.
  [[nodiscard]] std::uint32_t stage_us() const { return sequence_us() / kStages; }
  [[nodiscard]] std::uint32_t sequence_us() const { return static_cast<std::uint32_t>(shortest_ >> kFraction); }
  [[nodiscard]] bool stage_by_stage() const { return latching_ == wire::Latching::kEachStage; }
  [[nodiscard]] std::uint64_t wander(std::uint64_t sequences) const;
  // Stages that end between the anchor and the end of `stage` of the present sequence.
  [[nodiscard]] std::uint64_t stages_since_anchor(int stage) const {
    return std::uint64_t{since_anchor_ - 1} * kStages + static_cast<std::uint64_t>(stage) + 1;
  }
  void begin(std::uint64_t at_us);
  void contradict(std::uint64_t end);
  void measure_period();

  std::uint64_t first_ = 0, last_ = 0;                // The present sequence ends between these times.
  std::uint64_t shortest_ = 0, longest_ = 0;          // The period lies between these values.
  std::uint64_t anchor_first_ = 0, anchor_last_ = 0;  // These bound an earlier end, or the start.
  std::uint32_t since_anchor_ = 0, nominal_us_ = 0;
  int contradictions_ = 0;
  wire::Latching latching_ = wire::Latching::kEachStage;
};

}  // namespace triskin::fw

// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/wire/offsets.hpp"

namespace triskin::fw {

/// When one converter's sequence of twelve stages ends. The chip runs on an own oscillator (± 4 %) and signals no end.
/// What is known for certain is kept: an interval in which the present sequence ends, and one in which the period lies.
/// It begins with the moment at which the sequence was started. A reading of the stage-complete status shows whether a
/// stage had ended at a time and narrows the first interval; its growth since an earlier one narrows the second. All
/// stages last equally long, so any of them will do. Pure: time comes as an argument.
///
/// A burst of twelve results is whole when the last result is read after the end of the sequence and the first one
/// before stage 0 of the next is complete, wherever in the interval the end is: that is the window of read_us() …
/// last_start_us(). A chip that shows all results at the end of the sequence is read whole when the first result is
/// read after that end and the last one before the next. While it is not known which kind a chip is, the second window
/// counts: its results may then be of two sequences, but none is from before the start.
class SequenceClock {
 public:
  static constexpr std::uint32_t kTolerance_percent = 4;  ///< tolerance of the oscillator (AD7147 data sheet, table 1)
  /// Time between the start of a burst and its first result: six bytes.
  static constexpr std::uint64_t kFirstResult_us = 135;
  /// Time between the start and the high byte of its last result: 26 bytes.
  static constexpr std::uint64_t kLastResult_us = 585;
  static constexpr int kStages = 12;

  /// The sequence was started anew at `at_us`; nothing is known about the oscillator.
  void start(std::uint64_t at_us, std::uint32_t nominal_us, wire::Latching latching = wire::Latching::kEachStage);
  /// Time at which the chip shows its results, measured since the start.
  void set_latching(wire::Latching latching) { latching_ = latching; }
  /// The same, of a chip whose oscillator is known from before; unless the status contradicted that.
  void restart(std::uint64_t at_us);

  /// Middle of the interval in which the present sequence ends.
  [[nodiscard]] std::uint64_t end_us() const { return (first_ + last_) / 2 >> kFraction; }
  [[nodiscard]] std::uint64_t period_us() const { return (shortest_ + longest_) / 2 >> kFraction; }
  /// Length of the interval in which the present sequence ends.
  [[nodiscard]] std::uint64_t doubt_us() const { return (last_ - first_) >> kFraction; }
  /// How many sequences, 1 to `most`, may pass without a refinement: the period is known that well.
  [[nodiscard]] std::uint32_t may_pass(std::uint32_t most) const;
  /// First and last moment to start the burst for the present sequence.
  [[nodiscard]] std::uint64_t read_us() const {
    return (last_ >> kFraction) + kMargin_us - (stage_by_stage() ? kLastResult_us : kFirstResult_us);
  }
  [[nodiscard]] std::uint64_t last_start_us() const {
    return (first_ >> kFraction) + (stage_by_stage() ? stage_us() - kFirstResult_us : sequence_us() - kLastResult_us) -
           kMargin_us;
  }

  /// The end of the present sequence is not known well enough.
  [[nodiscard]] bool refinement_wanted() const { return doubt_us() > kWanted_us; }
  /// The sequence before the present one has ended for certain.
  [[nodiscard]] std::uint64_t began_us() const { return (last_ - shortest_) >> kFraction; }
  /// When `stage` (0..11) of the present sequence ends, as well as is known: the status shows most at that time.
  [[nodiscard]] std::uint64_t stage_end_us(int stage) const;
  /// Narrows what is known: the status, sampled at `at_us`, showed whether `stage` of the present sequence had `ended`.
  void refine(std::uint64_t at_us, int stage, bool ended);
  /// Goes on to the sequence after the present one, `count` times.
  void next(std::uint32_t count = 1);
  /// The status contradicts what was known again and again, or there was no time to read it: a start of the sequence
  /// gives more than a refinement.
  [[nodiscard]] bool uncertain() const;

 private:
  static constexpr unsigned kFraction = 16;        // Fractional bits of a microsecond.
  static constexpr std::uint64_t kMargin_us = 25;  // Safety margin around the first and last burst.
  // Error of the measured time of a start or of a reading of the status.
  static constexpr std::uint64_t kSlack = 25ULL << kFraction;
  static constexpr std::uint64_t kWanted_us = 120, kMaxGrowth_us = 300;
  static constexpr std::uint64_t kWander_ppm_per_s = 80;  // Drift of an oscillator that warms up.
  static constexpr std::uint32_t kAnchorFor = 64;         // The period is measured over this many sequences.
  static constexpr int kMaxContradictions = 4;

  // 32 bits are used because the loop reads it all the time, and the core cannot divide wider numbers.
  [[nodiscard]] std::uint32_t stage_us() const { return sequence_us() / kStages; }
  [[nodiscard]] std::uint32_t sequence_us() const { return static_cast<std::uint32_t>(shortest_ >> kFraction); }
  [[nodiscard]] bool stage_by_stage() const { return latching_ == wire::Latching::kEachStage; }
  [[nodiscard]] std::uint64_t wander(std::uint64_t sequences) const;
  void begin(std::uint64_t at_us);
  void contradict(std::uint64_t end);
  void measure_period();

  std::uint64_t first_ = 0, last_ = 0;                // The present sequence ends between these.
  std::uint64_t shortest_ = 0, longest_ = 0;          // The period lies between these.
  std::uint64_t anchor_first_ = 0, anchor_last_ = 0;  // Bounds of an earlier end, or of the start.
  std::uint32_t since_anchor_ = 0, nominal_us_ = 0;
  int contradictions_ = 0;
  wire::Latching latching_ = wire::Latching::kEachStage;
};

}  // namespace triskin::fw

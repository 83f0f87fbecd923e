// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace triskin::fw {

/// When one converter's sequence of twelve stages ends. The chip runs on its own oscillator (± 4 %) and tells nobody, so the end is
/// predicted: from the moment at which power control was written, and from looks at the stage-complete status. A look says
/// only whether the present sequence had ended at a time. While the period is not known well, each look halves the interval that it lies in;
/// later, looks just before and just after the predicted end fence it in, the more seldom the better they agree. Pure: time comes as an argument.
///
/// A burst of twelve results is whole when the last result is read after the end of the sequence and the first one before stage 0
/// of the next is complete: that is the window of read_us() … last_start_us().
class SequenceClock {
 public:
  static constexpr std::uint32_t kTolerance_percent = 4;      ///< of the oscillator (AD7147 data sheet, table 1)
  static constexpr std::uint64_t kFirstResult_us = 135;       ///< from the start of a burst to its first result: six bytes
  static constexpr std::uint64_t kLastResult_us = 585;        ///< … to the high byte of its last one: 26 bytes
  static constexpr std::uint64_t kStatusRead_us = 115;        ///< from the start of reading the status to the chip's sampling of it

  /// The sequence was started anew at `at_us`; nothing is known about the oscillator.
  void start(std::uint64_t at_us, std::uint32_t nominal_us);
  /// The same, of a chip whose oscillator is known from before.
  void restart(std::uint64_t at_us);

  [[nodiscard]] std::uint64_t end_us() const { return end_ >> kFraction; }
  [[nodiscard]] std::uint64_t period_us() const { return period_ >> kFraction; }
  /// The period is known well enough.
  [[nodiscard]] bool locked() const { return locked_; }
  /// Best and last moment to start the burst for the present sequence. Early when locked: two chips that end together fit into it.
  [[nodiscard]] std::uint64_t read_us() const;
  [[nodiscard]] std::uint64_t last_start_us() const { return end_us() + stage_us_ - kFirstResult_us - kMargin_us; }

  /// The end of the present sequence shall be looked at. The status must be cleared (read) after the end of the one before.
  [[nodiscard]] bool look_wanted() const { return !locked_ || since_look_ >= look_every_; }
  /// When to start reading the status.
  [[nodiscard]] std::uint64_t look_us() const;
  /// The status, sampled at `at_us`, said whether the present sequence had ended.
  void looked(std::uint64_t at_us, bool ended);
  /// The status said nothing: the chip may have been started anew, which others find out.
  void look_in_vain() { since_look_ = 0; }
  /// Goes on to the sequence after the present one, `count` times.
  void next(std::uint32_t count = 1);
  /// Looks contradict the prediction again and again, or there was no time for one: start the sequence anew.
  [[nodiscard]] bool uncertain() const { return contradictions_ >= kMaxContradictions || since_look_ >= 2 * look_every_ + 4; }

 private:
  static constexpr unsigned kFraction = 8;  // bits after the point of a microsecond
  static constexpr std::uint64_t kMargin_us = 150;  // error of the prediction
  static constexpr std::int64_t kFence_us = 40;      // looks that far before and after the predicted end
  static constexpr std::uint64_t kLate_us = 45, kSlack_us = 60;  // the start is noticed that late, more or less
  static constexpr std::uint32_t kMostSeldom = 8;    // sequences between two looks, once several have agreed
  static constexpr int kAgreements = 4;
  static constexpr std::uint32_t kLockAfter = 8;
  static constexpr int kMaxContradictions = 12;

  void narrow(std::uint64_t at_us, bool ended);
  void fence(std::uint64_t at_us, bool ended);

  std::uint64_t start_ = 0, end_ = 0, period_ = 0, least_ = 0, most_ = 0;  // with fraction
  std::uint64_t stage_us_ = 0;
  std::uint32_t sequences_ = 1;  // since the start, counting the present one
  std::uint32_t since_look_ = 0, look_every_ = 1;
  bool locked_ = false, before_ = false;
  int contradictions_ = 0, agreements_ = 0;
};

}  // namespace triskin::fw

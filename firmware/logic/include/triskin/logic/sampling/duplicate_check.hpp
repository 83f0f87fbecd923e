// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/drivers/ad7147.hpp"

namespace triskin::fw {

/// Tells one chip at an address from two. Two chips answer together, which the bus does not show: their data combine as
/// a wired AND. So a chip is read at both inputs of its converter, with the same offsets.
///
/// The results of an ideal chip mirror each other at mid scale: their sum is 65,536. What a real chip adds is the same
/// for all stages with the same offset, however uneven the steps of its two offset DACs are (zero error, path, DACs),
/// or grows with the result (unequal gains at both inputs). The wired AND of two chips whose taxels rest d counts apart
/// lacks at least d, mostly much more, and another amount at each taxel, because x AND y = (x + y - (x XOR y)) / 2 and
/// x XOR y ≥ |x - y|. So the offsets are rounded to a few codes, and taxels that share a code are compared. A second
/// comparison with codes in between finds what the bits of the first happened to hide.
class DuplicateCheck {
 public:
  /// Above this mean residual two chips are suspected. Of 4,000 chips drawn evenly from the ranges of docs/silicon.md
  /// one reaches 28; with every property at an end of its range up to 43, and 2 of 100,000 such chips are suspected.
  /// Two whose taxels differ by up to 100 fF leave at least 477 (tests/firmware).
  static constexpr float kMaxResidual_counts = 40.0F;
  /// One chip is off by at most 18,600 (docs/silicon.md). A larger deficit is a second chip, also where one of the
  /// results is at an end of the range.
  static constexpr std::int32_t kMaxDeviation_counts = 0x4C00;
  /// The gains of both inputs differ by at most this share.
  static constexpr float kMaxGain = 0.05F;
  /// A taxel that is pressed between the readings, or stuck, does not count.
  static constexpr int kMaxOutliers = 1;
  /// With fewer comparisons of two taxels there is too little to judge.
  static constexpr std::size_t kMinCompared = 3;
  /// So many suspicions in a row are required: a hand that moves on the skin between two readings looks the same once.
  static constexpr int kMinSuspicions = 3;
  static constexpr std::uint64_t kPause_us = 1'000'000;  ///< A duplicate is checked again after this pause.
  /// Codes of a comparison are so many steps apart: taxels stay within 5 pF of their offsets, and at most five codes
  /// are used.
  static constexpr int kCodeSteps = 16;
  static constexpr int kComparisons = 2;

  enum class Verdict : std::uint8_t {
    kUndecided,  ///< Both inputs must be read with the next offsets(), or again.
    kSingle,
    kDuplicate,  ///< Suspected kMinSuspicions times; after the pause one more such comparison is enough.
  };

  /// Starts with the first comparison.
  void begin() { comparison_ = 0; }
  /// Returns the offsets with which both inputs must be read, near those that fit the electrodes.
  [[nodiscard]] ad7147::Offsets offsets(const ad7147::Offsets& fitting) const;
  /// Judges results of both inputs, read with `offsets`.
  [[nodiscard]] Verdict compare(const ad7147::Results& other, const ad7147::Results& used,
                                const ad7147::Offsets& offsets);
  /// Returns the mean residual in counts; infinity where more than kMaxOutliers taxels deviate by more than
  /// kMaxDeviation_counts; 0 if there is too little to judge. Cost: some 2,000 operations on 12 points.
  [[nodiscard]] static float residual_counts(const ad7147::Results& other, const ad7147::Results& used,
                                             const ad7147::Offsets& offsets);

 private:
  int suspicions_ = 0;
  int comparison_ = 0;
};

}  // namespace triskin::fw

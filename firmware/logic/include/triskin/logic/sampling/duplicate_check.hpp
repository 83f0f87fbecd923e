// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/drivers/ad7147.hpp"

namespace triskin::fw {

/// Tells one chip at an address from two. Two chips answer together, which the bus does not show: their data combine as
/// a wired AND. So a chip is read at both inputs of its converter, with the same offsets.
///
/// The results of an ideal chip mirror each other at mid scale: their sum is 65,536. What a real chip adds is the same
/// at each stage (zero error, capacitance of a path) or grows evenly with the offset of the stage (offset DACs of
/// unequal and uneven steps): a parabola over the offsets, which is fitted and taken away. The wired AND of two chips
/// whose taxels rest d counts apart lacks at least d, another d at each taxel and mostly much more, because
/// x AND y = (x + y - (x XOR y)) / 2 and x XOR y ≥ |x - y|; no parabola fits that. Two chips whose taxels rest alike
/// cannot be detected.
class DuplicateCheck {
 public:
  /// From this mean residual on two chips are suspected. Of 4,000 chips drawn from the ranges of docs/silicon.md one
  /// reaches 67; two chips, each taxel within 244 fF of the other's, leave at least 275 (tests/firmware).
  static constexpr float kMaxResidual_counts = 120.0F;
  /// One chip is off by at most 10,000: a tenth of 63 steps of 1,400, zero error and path. A larger deficit is a second
  /// chip, also where one of the results is at an end of the range.
  static constexpr std::int32_t kMaxDeviation_counts = 0x4000;
  /// A taxel that is pressed between the readings, or stuck, does not count.
  static constexpr int kMaxOutliers = 1;
  /// With fewer taxels within their range a parabola leaves too little to judge.
  static constexpr std::size_t kMinCompared = 6;
  /// So many suspicions in a row are required: a hand that moves on the skin between two readings looks the same once.
  static constexpr int kMinSuspicions = 3;
  static constexpr std::uint64_t kPause_us = 1'000'000;  ///< A duplicate is checked again after this pause.

  enum class Verdict : std::uint8_t {
    kSingle,
    kSuspected,  ///< Both inputs must be read again.
    kDuplicate,  ///< Suspected kMinSuspicions times; after the pause one more such reading is enough.
  };

  /// Judges results of both inputs, read with `offsets`.
  [[nodiscard]] Verdict compare(const ad7147::Results& other, const ad7147::Results& used,
                                const ad7147::Offsets& offsets);
  /// Returns the mean residual in counts; infinity where more than kMaxOutliers taxels deviate by more than
  /// kMaxDeviation_counts; 0 if fewer than kMinCompared can be compared. Cost: 12 points, two fits, some 1,000 floating
  /// point operations.
  [[nodiscard]] static float residual_counts(const ad7147::Results& other, const ad7147::Results& used,
                                             const ad7147::Offsets& offsets);

 private:
  int suspicions_ = 0;
};

}  // namespace triskin::fw

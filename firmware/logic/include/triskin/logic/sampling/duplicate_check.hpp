// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/drivers/ad7147.hpp"

namespace triskin::fw {

/// Tells one chip at an address from two. Two chips at one address answer together and nobody sees it on the bus:
/// their data are a wired AND. So a chip that was found is read at both inputs of its converter. The two results of
/// one chip mirror each other at mid scale; the wired AND of two chips that differ by d counts is smaller by d at
/// least, because x AND y = (x + y - (x XOR y)) / 2 and x XOR y ≥ |x - y|. Two chips whose taxels rest at exactly the
/// same counts cannot be told from one this way. Pure: results in, verdict out.
class DuplicateCheck {
 public:
  static constexpr std::uint32_t kMinDeficit = 32;  ///< two chips are suspected from this mean deficit on, counts
  /// Required in a row, since a release between the two readings looks the same once.
  static constexpr int kMinSuspicions = 3;
  static constexpr std::uint64_t kPause_us = 1'000'000;  ///< pause before a duplicate is checked again

  enum class Verdict : std::uint8_t {
    kSingle,
    kSuspected,  ///< read both inputs again
    kDuplicate,  ///< seen kMinSuspicions times; after the pause one more reading like it is enough
  };

  /// One chip was found here since it was last absent: no check is needed.
  [[nodiscard]] bool passed() const { return passed_; }
  /// Who answers here next may be another chip, or two.
  void forget() { passed_ = false; }
  /// The chip of before is still there.
  void confirm() { passed_ = true; }
  /// Results of the input that is not used later, to be compared with the next ones of the other.
  void store_other(const ad7147::Results& results) { other_ = results; }
  /// What store_other() was given last; once the check has passed the caller may keep other results there.
  [[nodiscard]] const ad7147::Results& other() const { return other_; }
  /// Results of the input that is used, with the same offsets. Taxels at an end of their range in either reading do not
  /// count.
  [[nodiscard]] Verdict compare(const ad7147::Results& used);

 private:
  ad7147::Results other_{};
  int suspicions_ = 0;
  bool passed_ = false;
};

}  // namespace triskin::fw

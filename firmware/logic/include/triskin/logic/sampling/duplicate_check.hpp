// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/drivers/ad7147.hpp"

namespace triskin::fw {

/// Distinguishes one chip at an address from two. Two chips at one address answer together, which the bus does not
/// show, because their data combine as a wired AND. So a chip that was found is read at both inputs of its converter.
/// The two results of one chip mirror each other at mid scale; the wired AND of two chips that differ by d counts is
/// smaller by at least d, because x AND y = (x + y - (x XOR y)) / 2 and x XOR y ≥ |x - y|. Two chips whose taxels
/// rest at exactly the same counts cannot be detected this way. It makes no transfers: it receives results and gives a
/// verdict.
class DuplicateCheck {
 public:
  static constexpr std::uint32_t kMinDeficit = 32;  ///< From this mean deficit on, in counts, two chips are suspected.
  /// So many in a row are required, because a release between the two readings looks the same once.
  static constexpr int kMinSuspicions = 3;
  static constexpr std::uint64_t kPause_us = 1'000'000;  ///< A duplicate is checked again after this pause.

  enum class Verdict : std::uint8_t {
    kSingle,
    kSuspected,  ///< Both inputs must be read again.
    kDuplicate,  ///< The deficit was seen kMinSuspicions times; after the pause one more such reading is enough.
  };

  /// Compares results of both inputs, read with the same offsets. Taxels at an end of their range in either reading do
  /// not count.
  [[nodiscard]] Verdict compare(const ad7147::Results& other, const ad7147::Results& used);

 private:
  int suspicions_ = 0;
};

}  // namespace triskin::fw

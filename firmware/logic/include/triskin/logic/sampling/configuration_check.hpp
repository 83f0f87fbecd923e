// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstdint>

#include "triskin/drivers/ad7147.hpp"

namespace triskin::fw {

/// Decides when the configuration of a chip is read back: regularly, and before results count that an unconfigured chip
/// would give as well. It makes no transfers.
class ConfigurationCheck {
 public:
  static constexpr std::uint8_t kEvery = 16;  ///< The configuration is read back after this many readings.

  /// Notes that the configuration was written, or found correct.
  void confirmed() { unchecked_ = 0; }
  /// Makes the next results count only if the configuration is correct, because another chip may have been read.
  void require() { required_ = true; }
  /// Returns true if `results` count only when the configuration is correct. An unconfigured chip reads like one at the
  /// end of its range.
  [[nodiscard]] bool needed_for(const ad7147::Results& results);
  /// Notes that results were used without a check. Returns true if a check is due, when the line has time for it.
  [[nodiscard]] bool due_after_reading() { return due_after(1); }
  /// The same after a sequence that could not be read; the second one makes a check due. Without its configuration a
  /// chip shows no end of a sequence, and would be waited for.
  [[nodiscard]] bool due_after_missing() { return due_after(kEvery / 2); }
  [[nodiscard]] bool due() const { return unchecked_ >= kEvery; }

 private:
  [[nodiscard]] bool due_after(int readings) {
    unchecked_ = static_cast<std::uint8_t>(std::min(unchecked_ + readings, int{kEvery}));
    return due();
  }

  std::uint8_t unchecked_ = 0;  // Readings are counted from the last check.
  bool required_ = false;
};

}  // namespace triskin::fw

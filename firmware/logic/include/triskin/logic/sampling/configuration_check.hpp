// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "triskin/drivers/ad7147.hpp"

namespace triskin::fw {

/// When the configuration of a chip is read back: now and then, and before results count that a chip without
/// configuration would give as well. Pure.
class ConfigurationCheck {
 public:
  static constexpr std::uint8_t kEvery = 16;  ///< readings between two checks

  /// The configuration was written, or found as written.
  void confirmed() { unchecked_ = 0; }
  /// The next results count only when the configuration holds: another chip may have been read.
  void require() { required_ = true; }
  /// `results` were read. True: they count only when the configuration holds. A chip without it reads like one at the
  /// end of its range.
  [[nodiscard]] bool needed_for(const ad7147::Results& results);
  /// Results were used without a check. True: a check is due, when the line has time for it.
  [[nodiscard]] bool due_after_reading() { return ++unchecked_ >= kEvery; }

 private:
  std::uint8_t unchecked_ = 0;  // Readings since the last check.
  bool required_ = false;
};

}  // namespace triskin::fw

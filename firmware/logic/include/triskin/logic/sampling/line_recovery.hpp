// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace triskin::fw {

/// Decides how often a line that is held low is recovered: at most three times in a row, then it is left alone for a
/// second. The caller clocks the line free and reports whether that helped.
class LineRecovery {
 public:
  static constexpr int kMaxInRow = 3;
  static constexpr std::uint64_t kPause_us = 1'000'000;

  /// Reports that a transfer found the line held low. Returns true if the caller must recover it and call recovered(),
  /// false if the line is left alone until paused_until_us().
  [[nodiscard]] bool held_low(std::uint64_t now_us);
  /// Reports the result of the recovery; `free` means that neither SDA nor SCL is low any more.
  void recovered(bool free) { stuck_ = !free; }
  /// Reports that a transfer ended on a line that is not held low.
  void line_works();
  /// Discards the history of the line, including a pause.
  void restart();
  /// Ends the pause because it is over or the line is needed.
  void end_pause() { paused_until_us_ = 0; }

  /// Zero means that the line is not paused.
  [[nodiscard]] std::uint64_t paused_until_us() const { return paused_until_us_; }
  /// Returns true while the line is held low, as far as is known.
  [[nodiscard]] bool stuck() const { return stuck_; }
  /// Recoveries are counted from the start of the sampler.
  [[nodiscard]] std::uint32_t count() const { return count_; }

 private:
  std::uint64_t paused_until_us_ = 0;
  std::uint32_t count_ = 0;
  int in_row_ = 0;
  bool stuck_ = false;
};

}  // namespace triskin::fw

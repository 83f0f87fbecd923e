// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace triskin::fw {

/// How often a line that is held low is recovered: at most three times in a row, then it is left alone for a second.
/// Pure: the caller clocks the line free and reports whether that helped.
class LineRecovery {
 public:
  static constexpr int kMaxInRow = 3;
  static constexpr std::uint64_t kPause_us = 1'000'000;

  /// A transfer found the line held low. True: recover it now, then call recovered(). False: it is left alone until
  /// paused_until_us().
  [[nodiscard]] bool held_low(std::uint64_t now_us);
  /// Result of the recovery: `free` when neither SDA nor SCL is low any more.
  void recovered(bool free) { stuck_ = !free; }
  /// A transfer ended on a line that is not held low.
  void line_works();
  /// Forgets the past of the line, also a pause.
  void restart();
  /// The pause is over, or something else asks for the line.
  void end_pause() { paused_until_us_ = 0; }

  [[nodiscard]] std::uint64_t paused_until_us() const { return paused_until_us_; }  ///< 0: it is not paused
  /// True while the line is held low as far as is known.
  [[nodiscard]] bool stuck() const { return stuck_; }
  [[nodiscard]] std::uint32_t count() const { return count_; }  ///< recoveries since the sampler began

 private:
  std::uint64_t paused_until_us_ = 0;
  std::uint32_t count_ = 0;
  int in_row_ = 0;
  bool stuck_ = false;
};

}  // namespace triskin::fw

// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace triskin::fw {

/// Decides when the address of a module is asked for its chip, and whether a chip that gave no answer may continue as
/// it was. Time is an argument.
class Presence {
 public:
  static constexpr std::uint64_t kRecent_us = 100'000;  ///< The time is used by lost_recently().

  /// Schedules the next attempt for `at_us`.
  void ask_at(std::uint64_t at_us) { ask_us_ = at_us; }
  [[nodiscard]] std::uint64_t ask_us() const { return ask_us_; }
  /// Notes that the attempt that began at `began_us` failed by `now_us`. The next one is scheduled one `period_us`
  /// after the planned time, so that attempts stay in step however long each waited for the line; if that has passed,
  /// after `began_us`.
  void failed(std::uint64_t began_us, std::uint64_t now_us, std::uint64_t period_us);
  /// Notes that the chip was read until `now_us` and then gave no answer.
  void lost(std::uint64_t now_us) { lost_us_ = now_us; }
  /// Returns true if the chip was lost within the last kRecent_us. When modules are routed again, the old route is then
  /// to blame.
  [[nodiscard]] bool lost_recently(std::uint64_t now_us) const {
    return lost_us_ != 0 && now_us - lost_us_ < kRecent_us;
  }

 private:
  std::uint64_t ask_us_ = 0;
  std::uint64_t lost_us_ = 0;  // Zero means never.
};

}  // namespace triskin::fw

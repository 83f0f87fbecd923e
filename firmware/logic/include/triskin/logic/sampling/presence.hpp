// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace triskin::fw {

/// When the address of a module is asked for its chip, and whether a chip that gave no answer may be taken up again as
/// it was. Pure: time comes as an argument.
class Presence {
 public:
  static constexpr std::uint64_t kRecent_us = 100'000;  ///< see lost_recently()

  /// Ask from `at_us` on.
  void ask_at(std::uint64_t at_us) { ask_us_ = at_us; }
  [[nodiscard]] std::uint64_t ask_us() const { return ask_us_; }
  /// The attempt that began at `began_us` failed by `now_us`: ask again one `period_us` after the time that was set,
  /// so that attempts stay in step however long each waited for the line; if that has passed, after `began_us`.
  void failed(std::uint64_t began_us, std::uint64_t now_us, std::uint64_t period_us);
  /// The chip was read until `now_us` and then gave no answer.
  void lost(std::uint64_t now_us) { lost_us_ = now_us; }
  /// It was lost within the last kRecent_us: when modules are routed anew, the old route was to blame.
  [[nodiscard]] bool lost_recently(std::uint64_t now_us) const {
    return lost_us_ != 0 && now_us - lost_us_ < kRecent_us;
  }

 private:
  std::uint64_t ask_us_ = 0;
  std::uint64_t lost_us_ = 0;  // 0: never
};

}  // namespace triskin::fw

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <functional>

namespace triskin::pipeline {

using Clock = std::chrono::steady_clock;

[[nodiscard]] inline double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Returns true from `end_s` after `start` on. Empty with a fixed number of `iterations`, because the result must not
/// depend on the time.
[[nodiscard]] inline std::function<bool()> give_up_at(Clock::time_point start, double end_s, int iterations) {
  if (iterations > 0) return {};
  return [start, end_s] { return seconds_since(start) > end_s; };
}

}  // namespace triskin::pipeline

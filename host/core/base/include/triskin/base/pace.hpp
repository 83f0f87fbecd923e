// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <cstdint>

namespace triskin {

/// Sleeps until `end` of the monotonic clock, in slices of 20 ms, so that a request to end the process
/// (interrupt_request()) ends the sleep too. Returns false in that case. Steps of the wall clock have no effect.
/// Threads: any.
bool sleep_until(std::chrono::steady_clock::time_point end);

/// Slows a link whose own time runs faster down to real time, as for a simulation in this process. A link that falls
/// behind by more than 0.2 s, or a process that was stopped, does not catch up: the delay is accepted. Paces by the
/// monotonic clock; the wall clock gives labels only. Threads: one.
class Pace {
 public:
  /// `link_us` is the present time of the link, µs.
  explicit Pace(std::uint64_t link_us);
  /// Waits until as much time has passed here as on the link; a request to end the process ends the wait.
  void hold(std::uint64_t link_us);
  /// Converts a time of the link to a wall-clock label, µs since 1970. A step of the wall clock shows from the next
  /// hold() on.
  [[nodiscard]] std::int64_t unix_us(std::uint64_t link_us) const {
    return unix_minus_link_us_ + static_cast<std::int64_t>(link_us);
  }

 private:
  void anchor(std::uint64_t link_us);
  void label(std::uint64_t link_us);

  std::uint64_t link_start_us_ = 0;
  std::chrono::steady_clock::time_point start_;
  std::int64_t unix_minus_link_us_ = 0;
};

}  // namespace triskin

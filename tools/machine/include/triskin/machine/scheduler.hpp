// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <utility>

namespace triskin::machine {

/// Counts virtual time since power-up in ps, which is exact for every clock of the chip; the type holds 213 days.
using Time = std::uint64_t;
inline constexpr Time kMicrosecond = 1'000'000, kSecond = 1'000'000'000'000, kNever = ~Time{0};

/// Keeps an event queue in virtual time. Events of equal time run in the order in which they were booked, so a run is
/// deterministic.
class Scheduler {
 public:
  /// Returns the virtual time since power-up, ps.
  [[nodiscard]] Time now() const { return now_; }
  /// Returns the virtual time since power-up, whole µs.
  [[nodiscard]] std::uint64_t now_us() const { return now_ / kMicrosecond; }
  /// Advances time by `by` ps. Runs nothing: call run_due().
  void advance(Time by) { now_ += by; }
  /// Advances time to `to` ps since power-up; never back. Runs nothing.
  void advance_to(Time to) {
    if (to > now_) now_ = to;
  }
  /// Books `action` for `delay` ps from now. The action may book others.
  void after(Time delay, std::function<void()> action) {
    events_.emplace(now_ + delay, std::move(action));
    changed_ = true;
  }
  /// Returns the time of the earliest booked action, ps since power-up; kNever if none is booked.
  [[nodiscard]] Time next() const { return events_.empty() ? kNever : events_.begin()->first; }
  /// Runs all actions whose time has come, earliest first, also those that they book for now.
  void run_due() {
    while (!events_.empty() && events_.begin()->first <= now_) {
      auto action = std::move(events_.begin()->second);
      events_.erase(events_.begin());
      action();
    }
  }
  /// Drops all booked actions, as a reset does. Time stays.
  void clear() { events_.clear(); }
  /// Returns true once after a new event was booked.
  [[nodiscard]] bool take_changed() { return std::exchange(changed_, false); }

 private:
  std::multimap<Time, std::function<void()>> events_;
  Time now_ = 0;
  bool changed_ = false;
};

}  // namespace triskin::machine

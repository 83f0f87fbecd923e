// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <utility>

namespace triskin::machine {

/// Virtual time in picoseconds since power-up: exact for every clock of the chip, and wide enough for 213 days.
using Time = std::uint64_t;
inline constexpr Time kMicrosecond = 1'000'000, kSecond = 1'000'000'000'000, kNever = ~Time{0};

/// Things that happen at a time. Equal times run in the order of their booking: a run is deterministic.
class Scheduler {
 public:
  [[nodiscard]] Time now() const { return now_; }
  [[nodiscard]] std::uint64_t now_us() const { return now_ / kMicrosecond; }
  void advance(Time by) { now_ += by; }
  void advance_to(Time to) {
    if (to > now_) now_ = to;
  }
  void after(Time delay, std::function<void()> action) {
    events_.emplace(now_ + delay, std::move(action));
    changed_ = true;
  }
  [[nodiscard]] Time next() const { return events_.empty() ? kNever : events_.begin()->first; }
  void run_due() {
    while (!events_.empty() && events_.begin()->first <= now_) {
      auto action = std::move(events_.begin()->second);
      events_.erase(events_.begin());
      action();
    }
  }
  void clear() { events_.clear(); }
  /// True once after a new event was booked.
  [[nodiscard]] bool take_changed() { return std::exchange(changed_, false); }

 private:
  std::multimap<Time, std::function<void()>> events_;
  Time now_ = 0;
  bool changed_ = false;
};

}  // namespace triskin::machine

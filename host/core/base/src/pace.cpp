// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/base/pace.hpp"

#include <algorithm>
#include <thread>

#include "triskin/base/interrupt.hpp"
#include "triskin/base/wall_clock.hpp"

namespace triskin {
namespace {

using Monotonic = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kSleepSlice{20}, kMaxBehind{200};

}  // namespace

bool sleep_until(Monotonic::time_point end) {
  while (!interrupt_request()) {
    const auto now = Monotonic::now();
    if (now >= end) return true;
    std::this_thread::sleep_for(std::min<Monotonic::duration>(end - now, kSleepSlice));
  }
  return false;
}

Pace::Pace(std::uint64_t link_us) {
  anchor(link_us);
}

void Pace::hold(std::uint64_t link_us) {
  const auto due = start_ + std::chrono::microseconds(link_us - link_start_us_);
  (void)triskin::sleep_until(due);
  if (Monotonic::now() - due > kMaxBehind) anchor(link_us);
  label(link_us);
}

void Pace::anchor(std::uint64_t link_us) {
  link_start_us_ = link_us;
  start_ = Monotonic::now();
  label(link_us);
}

void Pace::label(std::uint64_t link_us) {
  unix_minus_link_us_ = static_cast<std::int64_t>(unix_ns() / 1000) - static_cast<std::int64_t>(link_us);
}

}  // namespace triskin

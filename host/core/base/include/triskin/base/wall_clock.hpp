// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <chrono>
#include <cstdint>
#include <string>

namespace triskin {

/// Returns the time of this computer, ns since 1970 without leap seconds. It may be set while the program runs.
/// Constant cost.
[[nodiscard]] inline std::uint64_t unix_ns() {
  using namespace std::chrono;
  return static_cast<std::uint64_t>(duration_cast<nanoseconds>(system_clock::now().time_since_epoch()).count());
}

/// Writes a time in seconds since 1970 as ISO 8601 text in UTC: "2026-11-22T17:30:00Z". Constant cost.
[[nodiscard]] std::string utc_text(std::uint64_t unix_s);

}  // namespace triskin

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <optional>
#include <string>

namespace triskin::geometry {

/// Does `work` in a child process and returns its bytes; empty when the child crashed, was ended by the library, used
/// more than `cpu_s` seconds of processor time or ten times that on the clock, or `is_late` (may be empty; asked every
/// 20 ms) says that it has to end. `work` must not throw and must not wait for other threads.
[[nodiscard]] std::optional<std::string> run_isolated(const std::function<std::string()>& work, unsigned cpu_s,
                                                      const std::function<bool()>& is_late = {});

}  // namespace triskin::geometry

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace triskin::mesh {

struct IsolatedLimits {
  unsigned cpu_s = 1;  ///< The child may use this much processor time, and ten times that of wall-clock time.
  std::uint64_t memory_bytes = 0;  ///< The child may allocate this much more than the parent has; 0 sets no limit.
};

/// Does `work` in a child process and returns its bytes. Returns nothing when the child crashed, was ended by the
/// library, exceeded a limit, or when `is_late` (may be empty; asked every 20 ms) tells it to end. `work` must not
/// throw and must not wait for other threads. Throws InputError when no child process can be started.
[[nodiscard]] std::optional<std::string> run_isolated(const std::function<std::string()>& work,
                                                      const IsolatedLimits& limits,
                                                      const std::function<bool()>& is_late = {});

}  // namespace triskin::mesh

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <exception>
#include <functional>
#include <span>
#include <vector>

#include "triskin/session/bus.hpp"

namespace triskin::session {

/// A task makes requests to one controller, written as sequential code that blocks in the calls of its Bus.
struct Task {
  std::uint8_t node = 0;          ///< The task receives only the answers of this node, 1 to 126.
  std::function<void(Bus&)> run;  ///< The function gets its own Bus, which is valid until it returns.
};

/// With this many conversations on one wire, the others fill the time in which one controller erases a page
/// (docs/decisions.md).
inline constexpr int kTasksPerWire = 16;

/// Runs tasks concurrently over one link: while one waits for a frame, another runs. Exactly one task runs at any time,
/// and the order depends on the link alone, so neither the link nor the tasks need locks, and a simulated link stays
/// deterministic. At most `per_wire` tasks (values below 1 count as 1) are active on one wire (Link::wire_of). Returns
/// once all tasks have ended; element k holds the exception that task k threw, or null. A failure of the link is thrown
/// in the task that waits for the earliest time; no exception of a task leaves this function. Cost: one
/// operating-system thread per task, created when the task starts (docs/decisions.md). Call it
/// from one thread; `link`, `tasks` and the objects that the tasks use must outlive the call. A task must not call
/// run_tasks.
[[nodiscard]] std::vector<std::exception_ptr> run_tasks(link::Link& link, std::span<const Task> tasks,
                                                        int per_wire = 1);

}  // namespace triskin::session

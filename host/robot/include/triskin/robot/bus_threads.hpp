// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace triskin::robot {

/// Runs `work(k)` for each k of `names`, side by side: one thread a bus, so that the time is that of the slowest. One
/// bus alone is served in the calling thread. Returns when all have ended. When some failed: throws what the first of
/// them threw (InputError, Cancelled, else DeviceError), with the names of all that failed and how many buses did what
/// was asked. `work` must be safe to call from several threads with different k.
void on_each_bus(const std::vector<std::string>& names, const std::function<void(std::size_t k)>& work);

}  // namespace triskin::robot

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace triskin::robot {

/// Runs `work(k)` for each k of `names` in parallel, with one thread for each bus, so that the slowest one determines
/// the time. A single bus is served in the calling thread. Returns when all have ended. If some failed, throws the
/// exception of the first of them (InputError, Cancelled, else DeviceError), with the names of all that failed and the
/// number of buses that succeeded. `work` must be safe to call from several threads with different k.
void on_each_bus(const std::vector<std::string>& names, const std::function<void(std::size_t k)>& work);

}  // namespace triskin::robot

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <set>

#include "triskin/hardware/scene.hpp"

namespace triskin::hardware {

/// Returns the times at which a fault that `concerns` accepts begins or ends, in µs. Cost: O(n log n) of the faults.
template <class Concerns>
[[nodiscard]] std::set<std::uint64_t> change_times_us(const Scene& scene, Concerns concerns) {
  std::set<std::uint64_t> times;
  for (const Fault& f : scene.faults) {
    if (!concerns(f)) continue;
    times.insert(f.from_us);
    if (f.until_us != kForever) times.insert(f.until_us);
  }
  return times;
}

}  // namespace triskin::hardware

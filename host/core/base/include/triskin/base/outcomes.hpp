// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <exception>
#include <vector>

#include "triskin/base/parallel.hpp"

namespace triskin {

/// Calls `work(k)` for k = 0 … count - 1 side by side, and returns when all have returned. Entry k of the result is
/// the exception of call k, or null. `work` must be safe to call from several threads at once. Cost: starts count - 1
/// threads.
[[nodiscard]] std::vector<std::exception_ptr> outcomes_of(std::size_t count, const auto& work) {
  std::vector<std::exception_ptr> outcomes(count);
  in_parallel(static_cast<int>(count), count, [&](std::size_t k) {
    try {
      work(k);
    } catch (...) {
      outcomes[k] = std::current_exception();
    }
  });
  return outcomes;
}

}  // namespace triskin

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace triskin {

/// Returns how many threads this computer runs side by side, ≥ 1.
[[nodiscard]] inline int all_threads() {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

/// Calls `work(k)` for k = 0 … count - 1, in no order, on `threads` threads (≥ 1), the caller's among them; returns
/// when all have returned. The first exception of a call is thrown again, and no further call begins. `work` must be
/// safe to call from several threads at once. Cost: starts a thread for each but the caller's, if there is work for it.
void in_parallel(int threads, std::size_t count, const auto& work) {
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr thrown;
  const auto run = [&] {
    try {
      for (std::size_t k = next++; k < count; k = next++) work(k);
    } catch (...) {
      const std::scoped_lock lock(mutex);
      if (thrown == nullptr) thrown = std::current_exception();
      next = count;
    }
  };
  {
    std::vector<std::jthread> others;
    for (int k = 1; k < threads && static_cast<std::size_t>(k) < count; ++k) others.emplace_back(run);
    run();
  }
  if (thrown != nullptr) std::rethrow_exception(thrown);
}

}  // namespace triskin

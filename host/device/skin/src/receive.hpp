// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>

#include "triskin/base/interrupt.hpp"
#include "triskin/skin/live_skin.hpp"

namespace triskin::skin {

/// All code that receives samples uses this loop. `receive(until_us)` waits for them until a time of the link, and
/// `now_us()` returns that time. The loop ends with the run, or when the process is asked to end.
template <class Now, class Receive>
void receive_slices(const LiveRun& run, Now now_us, Receive receive) {
  try {
    while (now_us() < run.until_us && !interrupt_request()) {
      if (run.before_slice) run.before_slice();
      receive(std::min(run.until_us, now_us() + run.slice_us));
      if (run.after_slice && !run.after_slice()) return;
    }
  } catch (const Cancelled&) {
    // Ctrl-C is the usual way to end a stream, so this is no error: everything until then was delivered.
  }
}

}  // namespace triskin::skin

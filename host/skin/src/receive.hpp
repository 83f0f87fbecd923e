// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>

#include "triskin/base/interrupt.hpp"
#include "triskin/skin/live_skin.hpp"

namespace triskin::device {

/// The loop of everything that receives samples: `receive(until_us)` waits for them until a time of the link, which
/// `now_us()` tells. Ends with the run, or when the process is asked to end.
template <class Now, class Receive>
void receive_slices(const LiveRun& run, Now now_us, Receive receive) {
  try {
    while (now_us() < run.until_us && !interrupt_request()) {
      if (run.before_slice) run.before_slice();
      receive(std::min(run.until_us, now_us() + run.slice_us));
      if (run.after_slice && !run.after_slice()) return;
    }
  } catch (const Cancelled&) {
    // A stream is ended by Ctrl-C as a rule: it has delivered all until then.
  }
}

}  // namespace triskin::device

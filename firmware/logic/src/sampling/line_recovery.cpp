// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/sampling/line_recovery.hpp"

namespace triskin::fw {

bool LineRecovery::held_low(std::uint64_t now_us) {
  stuck_ = true;
  if (in_row_ < kMaxInRow) {
    ++in_row_;
    ++count_;
    return true;
  }
  in_row_ = 0;
  paused_until_us_ = now_us + kPause_us;
  return false;
}

void LineRecovery::line_works() {
  in_row_ = 0;
  stuck_ = false;
}

void LineRecovery::restart() {
  line_works();
  paused_until_us_ = 0;
}

}  // namespace triskin::fw

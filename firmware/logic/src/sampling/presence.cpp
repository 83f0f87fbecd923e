// SPDX-License-Identifier: Apache-2.0
#include "triskin/logic/sampling/presence.hpp"

namespace triskin::fw {

void Presence::failed(std::uint64_t began_us, std::uint64_t now_us, std::uint64_t period_us) {
  ask_us_ += period_us;
  if (ask_us_ <= now_us) ask_us_ = began_us + period_us;
}

}  // namespace triskin::fw

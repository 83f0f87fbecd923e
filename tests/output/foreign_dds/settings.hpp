// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <string>
#include <thread>

namespace triskin::foreign {

/// Restricts Cyclone DDS to the loopback interface; `more` goes within <Internal> or <Tracing>.
inline std::string cyclone_settings(const std::string& more = "") {
  return "<General><Interfaces><NetworkInterface name=\"lo\"/></Interfaces><AllowMulticast>false</AllowMulticast>"
         "</General><Discovery><ParticipantIndex>auto</ParticipantIndex><Peers><Peer Address=\"127.0.0.1\"/></Peers>"
         "</Discovery>" +
         more;
}
/// Cyclone DDS then drops one packet in a hundred.
inline const std::string kOnePercentLost = "<Internal><Test><XmitLossiness>10</XmitLossiness></Test></Internal>";

/// Returns a domain of this process alone; Cyclone DDS in it uses cyclone_settings(more).
inline std::uint32_t domain_with(const std::string& more = "") {
  ::setenv("CYCLONEDDS_URI", cyclone_settings(more).c_str(), 1);
  return 20 + static_cast<std::uint32_t>(::getpid()) % 180;
}

/// Waits at most `seconds` for `done`; returns false if it did not become true.
inline bool wait_until(const std::function<bool()>& done, double seconds = 30.0) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!done()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace triskin::foreign

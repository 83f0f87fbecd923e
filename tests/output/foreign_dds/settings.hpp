// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "triskin/bridge/dds.hpp"

namespace triskin::foreign {

/// Returns a domain of this process and its children alone, on the loopback interface; a participant of Cyclone DDS
/// gets `more` within its settings.
inline std::uint32_t domain_with(const std::string& more = "") {
  const std::string settings =
      "<General><Interfaces><NetworkInterface name=\"lo\"/></Interfaces><AllowMulticast>false</AllowMulticast>"
      "</General><Discovery><ParticipantIndex>auto</ParticipantIndex><Peers><Peer Address=\"127.0.0.1\"/></Peers>"
      "</Discovery>" +
      more;
  ::setenv("CYCLONEDDS_URI", settings.c_str(), 1);
  ::setenv("ROS_LOCALHOST_ONLY", "1", 1);
  return 20 + static_cast<std::uint32_t>(::getpid()) % 180;
}
/// Joins it as the command does.
inline std::unique_ptr<bridge::Domain> join_loopback(std::uint32_t id) {
  return bridge::join_domain(id, {.range = bridge::DiscoveryRange::kLoopback, .peers = {}, .words = ""});
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

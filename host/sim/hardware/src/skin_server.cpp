// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/hardware/skin_server.hpp"

#include <algorithm>
#include <chrono>

#include "can_server.hpp"
#include "triskin/hardware/sim_server.hpp"
#include "usb_server.hpp"

namespace triskin::hardware {

namespace {

std::uint64_t wall_us() {
  const auto since_start = std::chrono::steady_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::microseconds>(since_start).count());
}

}  // namespace

void SkinServer::run(const std::atomic<bool>& stop, double seconds) {
  constexpr std::uint64_t kMaxAtOnce_us = 20'000;
  const std::uint64_t start_us = wall_us(), end_us = static_cast<std::uint64_t>(seconds * 1e6);
  std::uint64_t last_us = start_us;
  while (!stop) {
    const std::uint64_t now_us = wall_us();
    if (seconds > 0.0 && now_us - start_us >= end_us) break;
    skin_.run_until(skin_.now_us() + std::min(now_us - last_us, kMaxAtOnce_us));
    last_us = now_us;
    flush();
    wait(kStep_us);
  }
}

std::unique_ptr<SkinServer> open_server(hardware::VirtualSkin& skin, const std::string& at, Reach reach) {
  if (at.starts_with("can:")) return std::make_unique<CanServer>(skin, at.substr(4));
  if (at == "usb") return std::make_unique<UsbServer>(skin);
  return std::make_unique<SimServer>(skin, parse_host_port(at), reach);
}

}  // namespace triskin::hardware

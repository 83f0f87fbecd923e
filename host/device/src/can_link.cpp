// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/device/can_link.hpp"

#include <poll.h>

#include <algorithm>

#include "triskin/host/error.hpp"

namespace triskin::device {

CanLink::CanLink(const std::string& interface) : name_("can:" + interface), socket_(interface) { socket_.filter_for_host(); }

std::uint64_t CanLink::now_us() const {
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start_).count());
}

std::optional<wire::CanFrame> CanLink::receive(std::uint64_t until_us) {
  while (true) {
    if (auto frame = socket_.receive()) return frame;
    if (socket_.errors().bus_off) throw DeviceError(socket_.trouble());
    const std::uint64_t now = now_us();
    if (now >= until_us) return std::nullopt;
    const std::uint64_t left_us = std::min<std::uint64_t>(until_us - now, 1'000'000);
    const timespec timeout{0, static_cast<long>(std::min<std::uint64_t>(left_us, 999'999) * 1000)};
    pollfd p{socket_.descriptor(), POLLIN, 0};
    (void)::ppoll(&p, 1, &timeout, nullptr);
  }
}

}  // namespace triskin::device

// SPDX-License-Identifier: GPL-3.0-or-later
#include "can_server.hpp"

#include <poll.h>

namespace triskin::hardware {

CanServer::CanServer(hardware::VirtualSkin& skin, const std::string& interface)
    : SkinServer(skin), name_("can:" + interface), socket_(interface) {
  skin_.use_fd(socket_.fd());
  skin_.on_frame([this](const wire::CanFrame& frame, std::uint64_t) { socket_.send(frame); });
}

CanServer::~CanServer() {
  skin_.on_frame({});
}

void CanServer::wait(std::uint64_t timeout_us) {
  pollfd p{socket_.descriptor(), POLLIN, 0};
  const timespec timeout{0, static_cast<long>(timeout_us * 1000)};
  if (::ppoll(&p, 1, &timeout, nullptr) <= 0) return;
  while (const auto frame = socket_.receive()) skin_.send(*frame);
}

}  // namespace triskin::hardware

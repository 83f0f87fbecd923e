// SPDX-License-Identifier: GPL-3.0-or-later
#include "usb_server.hpp"

#include <poll.h>

namespace triskin::hardware {

UsbServer::UsbServer(hardware::VirtualSkin& skin)
    : SkinServer(skin), sessions_(skin.controllers()), devices_(skin.controllers()) {
  for (std::size_t k = 0; k < devices_.size(); ++k) plug(k);
}

UsbServer::~UsbServer() = default;

void UsbServer::plug(std::size_t controller) {
  devices_[controller].reset();
  sessions_[controller] = skin_.usb_session(controller);
  devices_[controller] = std::make_unique<VhciDevice>(skin_.usb(controller), ++plugged_ + 1);
}

void UsbServer::flush() {
  for (std::size_t k = 0; k < devices_.size(); ++k) {
    if (sessions_[k] != skin_.usb_session(k) || !devices_[k]->alive()) plug(k);
    devices_[k]->write();
  }
}

void UsbServer::wait(std::uint64_t timeout_us) {
  std::vector<pollfd> sockets;
  for (const auto& d : devices_) sockets.push_back({d->descriptor(), POLLIN, 0});
  const timespec timeout{0, static_cast<long>(timeout_us * 1000)};
  if (::ppoll(sockets.data(), sockets.size(), &timeout, nullptr) <= 0) return;
  for (std::size_t k = 0; k < devices_.size(); ++k) {
    if (sockets[k].revents == 0 || !devices_[k]->read()) continue;
    skin_.wake(k);
    devices_[k]->write();
  }
}

}  // namespace triskin::hardware

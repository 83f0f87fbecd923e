// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/link/can_link.hpp"

#include <poll.h>

#include <algorithm>

#include "triskin/base/error.hpp"

namespace triskin::link {

// The link waits for its channels as well as for frames.
class CanLink::Channel final : public MessageChannel {
 public:
  Channel(CanLink& link, std::unique_ptr<CanChannel> channel) : link_(link), channel_(std::move(channel)) {
    link_.channels_.insert(channel_->descriptor());
  }
  ~Channel() override { link_.channels_.erase(channel_->descriptor()); }
  Channel(const Channel&) = delete;
  Channel& operator=(const Channel&) = delete;
  bool send(Bytes message) override { return channel_->send(message); }
  Arrival take(std::vector<std::uint8_t>& message) override { return channel_->take(message); }

 private:
  CanLink& link_;
  std::unique_ptr<CanChannel> channel_;
};

CanLink::CanLink(const std::string& interface) : interface_(interface), name_("can:" + interface), socket_(open()) {}

std::unique_ptr<CanSocket> CanLink::open() const {
  auto socket = std::make_unique<CanSocket>(interface_);
  socket->filter_for_host();
  return socket;
}

void CanLink::reconnect() {
  if (socket_->errors().bus_off || !socket_->alive()) socket_ = open();
}

std::uint64_t CanLink::now_us() const {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start_).count());
}

std::unique_ptr<MessageChannel> CanLink::open_channel(std::uint32_t tx_id, std::uint32_t rx_id) {
  auto channel = CanChannel::open(interface_, socket_->fd(), tx_id, rx_id);
  return channel ? std::make_unique<Channel>(*this, std::move(channel)) : nullptr;
}

bool CanLink::wait(std::uint64_t wait_us) const {
  const timespec timeout{0, static_cast<long>(std::min<std::uint64_t>(wait_us, 999'999) * 1000)};
  std::vector<pollfd> p{{socket_->descriptor(), POLLIN, 0}};
  for (const int descriptor : channels_) p.push_back({descriptor, POLLIN, 0});
  if (::ppoll(p.data(), p.size(), &timeout, nullptr) <= 0) return false;
  return std::any_of(p.begin() + 1, p.end(), [](const pollfd& each) { return each.revents != 0; });
}

std::optional<wire::CanFrame> CanLink::receive(std::uint64_t until_us) {
  while (true) {
    if (auto frame = socket_->receive()) return frame;
    if (socket_->errors().bus_off) throw Unreachable(socket_->trouble());
    const std::uint64_t now = now_us();
    if (now >= until_us) return std::nullopt;
    if (wait(until_us - now)) return socket_->receive();
  }
}

}  // namespace triskin::link

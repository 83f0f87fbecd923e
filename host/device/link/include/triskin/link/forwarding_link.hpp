// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/link/link.hpp"

namespace triskin::link {

/// A forwarding link passes frames, time, limits, names and channels to the link below. Derived classes forward the
/// rest of a complete link (actuator, parts, counts, reconnecting) if they need it. Use it in the thread of the link
/// below.
class ForwardingLink : public Link {
 public:
  void send(const wire::CanFrame& frame) override { link_.send(frame); }
  std::optional<wire::CanFrame> receive(std::uint64_t until_us) override { return link_.receive(until_us); }
  [[nodiscard]] std::uint64_t now_us() const override { return link_.now_us(); }
  [[nodiscard]] bool fd() const override { return link_.fd(); }
  [[nodiscard]] std::uint8_t frame_bytes() const override { return link_.frame_bytes(); }
  [[nodiscard]] std::uint64_t answer_us() const override { return link_.answer_us(); }
  [[nodiscard]] std::string name() const override { return link_.name(); }
  [[nodiscard]] std::string trouble() const override { return link_.trouble(); }
  [[nodiscard]] std::unique_ptr<MessageChannel> open_channel(std::uint32_t tx_id, std::uint32_t rx_id) override {
    return link_.open_channel(tx_id, rx_id);
  }
  [[nodiscard]] int wire_of(std::uint8_t node) const override { return link_.wire_of(node); }

 protected:
  /// `link` must outlive this object.
  explicit ForwardingLink(Link& link) : link_(link) {}

  Link& link_;
};

}  // namespace triskin::link

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/link/link.hpp"

namespace triskin::device {

/// A link as one of several covers on it sees it: the finger of a simulation counts the modules of all covers one after
/// the other, that of this link those of the cover. All else is the link's own. Threads: that of the link.
class CoverLink final : public Link, private Finger {
 public:
  /// `first_module`: number of the cover's module 0 on the simulated bus. `link` outlives this.
  CoverLink(Link& link, int first_module) : link_(link), first_module_(first_module) {}

  void send(const wire::CanFrame& frame) override { link_.send(frame); }
  std::optional<wire::CanFrame> receive(std::uint64_t until_us) override { return link_.receive(until_us); }
  [[nodiscard]] std::uint64_t now_us() const override { return link_.now_us(); }
  [[nodiscard]] bool fd() const override { return link_.fd(); }
  [[nodiscard]] std::uint8_t frame_bytes() const override { return link_.frame_bytes(); }
  [[nodiscard]] std::uint64_t answer_us() const override { return link_.answer_us(); }
  [[nodiscard]] std::string name() const override { return link_.name(); }
  [[nodiscard]] std::string trouble() const override { return link_.trouble(); }
  [[nodiscard]] Finger* finger() override { return link_.finger() == nullptr ? nullptr : this; }
  [[nodiscard]] std::unique_ptr<MessageChannel> open_channel(std::uint32_t tx_id, std::uint32_t rx_id) override {
    return link_.open_channel(tx_id, rx_id);
  }
  [[nodiscard]] int wire_of(std::uint8_t node) const override { return link_.wire_of(node); }
  [[nodiscard]] std::uint64_t sample_ns(std::uint8_t node) const override { return link_.sample_ns(node); }
  [[nodiscard]] std::uint64_t thrown_away() const override { return link_.thrown_away(); }
  void reconnect() override { link_.reconnect(); }

 private:
  void press(int module, int taxel) override { link_.finger()->press(first_module_ + module, taxel); }
  void lift() override { link_.finger()->lift(); }

  Link& link_;
  int first_module_;
};

}  // namespace triskin::device

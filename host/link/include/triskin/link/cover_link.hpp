// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/link/forwarding_link.hpp"

namespace triskin::device {

/// A link as one of several covers on it sees it: the finger of a simulation counts the modules of all covers one after
/// the other, that of this link those of the cover. All else is the link's own. Threads: that of the link.
class CoverLink final : public ForwardingLink, private Finger {
 public:
  /// `first_module`: number of the cover's module 0 on the simulated bus. `link` outlives this.
  CoverLink(Link& link, int first_module) : ForwardingLink(link), first_module_(first_module) {}

  [[nodiscard]] Finger* finger() override { return link_.finger() == nullptr ? nullptr : this; }
  [[nodiscard]] std::uint64_t sample_ns(std::uint8_t node) const override { return link_.sample_ns(node); }
  [[nodiscard]] std::uint64_t thrown_away() const override { return link_.thrown_away(); }
  void reconnect() override { link_.reconnect(); }

 private:
  void press(int module, int taxel) override { link_.finger()->press(first_module_ + module, taxel); }
  void lift() override { link_.finger()->lift(); }
  void pressurize(int module, double kpa) override {
    link_.finger()->pressurize(module < 0 ? module : first_module_ + module, kpa);
  }

  int first_module_;
};

}  // namespace triskin::device

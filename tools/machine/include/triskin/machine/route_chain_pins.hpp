// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "triskin/sim/chain_model.hpp"

namespace triskin::machine {

/// Models the scan chain at the pins of the controller: EN of the two cables at PB12 and PB10, latch at PB11, clock and
/// data at SPI2. Without modules the returned data are 0, by their pull-down.
class RouteChainPins {
 public:
  explicit RouteChainPins(sim::ChainModel* chain) : chain_(chain) {}
  void enable(std::uint8_t cables) {
    if (chain_ != nullptr) chain_->enable(cables);
  }
  void latch() {
    if (chain_ != nullptr) chain_->latch();
  }
  [[nodiscard]] std::uint8_t exchange(std::uint8_t out) {
    std::uint8_t in = 0;
    if (chain_ != nullptr) chain_->exchange({&out, 1}, {&in, 1});
    return in;
  }

 private:
  sim::ChainModel* chain_;
};

}  // namespace triskin::machine

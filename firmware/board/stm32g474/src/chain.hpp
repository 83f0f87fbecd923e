// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/ports/route_chain.hpp"

namespace triskin::board {

/// The route chain at SPI2, mode 0: the modules take data with the rising edge, and what they return is read at the
/// next one. The clock is PCLK / 64 = 2.66 MHz. The returned data have a pull-down: without switched modules everything
/// reads 0.
class Stm32RouteChain final : public fw::RouteChain {
 public:
  void open();
  void enable(std::uint8_t cables) override;
  void exchange(Bytes out, std::span<std::uint8_t> in) override;
  void latch() override;
  [[nodiscard]] std::uint8_t stuck_lines() override;
};

extern Stm32RouteChain route_chain;

}  // namespace triskin::board

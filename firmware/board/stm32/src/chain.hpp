// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/ports/route_chain.hpp"

namespace triskin::board {

/// SPI2 drives the route chain in mode 0: the modules read data at the rising edge, and their returned data are read at
/// the next one. The clock is PCLK / 64 = 2.66 MHz. The returned data have a pull-down, so everything reads 0 without
/// switched modules.
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

// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/board/registers/gpio.hpp"
#include "triskin/ports/route_chain.hpp"

namespace triskin::board {

/// The route chain on five pins, paced by the processor: below 2 MHz, as long as the switches of sixteen modules are fast enough for it.
/// The returned data have a pull-down: without switched modules everything reads 0.
class Stm32RouteChain final : public fw::RouteChain {
 public:
  void open();
  void enable(bool on) override;
  void exchange(Bytes out, std::span<std::uint8_t> in) override;
  void latch() override;
  [[nodiscard]] std::uint8_t stuck_lines() override;
};

extern Stm32RouteChain route_chain;

}  // namespace triskin::board

// SPDX-License-Identifier: Apache-2.0
#include "chain.hpp"

#include "line.hpp"
#include "triskin/board/board.hpp"

namespace triskin::board {
namespace {

constexpr Gpio kEnable{{'B', 12}}, kClock{{'B', 13}}, kDataIn{{'B', 14}}, kDataOut{{'B', 15}}, kLatch{{'B', 11}};
constexpr std::uint64_t kSettle_us = 5;

// A quarter of a microsecond at least: 14 passes of three cycles at 170 MHz, half a clock period.
inline void half_period() {
  for (int k = 0; k < 14; ++k) asm volatile("nop");
}

void settle() {
  const std::uint64_t end_us = microseconds() + kSettle_us + 1;
  while (microseconds() < end_us) {
  }
}

}  // namespace

Stm32RouteChain route_chain;

void Stm32RouteChain::open() {
  for (const Gpio& pin : {kEnable, kClock, kDataOut, kLatch}) {
    pin.drive(false);
    pin.mode(PinMode::kOutput);
  }
  kDataIn.pull_down();
  kDataIn.mode(PinMode::kInput);
}

void Stm32RouteChain::enable(bool on) {
  kEnable.drive(on);
  settle();
}

void Stm32RouteChain::exchange(Bytes out, std::span<std::uint8_t> in) {
  for (std::size_t byte = 0; byte < out.size(); ++byte) {
    std::uint8_t got = 0;
    for (int k = 7; k >= 0; --k) {
      kDataOut.drive((out[byte] >> k & 1) != 0);
      half_period();
      got = static_cast<std::uint8_t>(got << 1 | (kDataIn.level() ? 1 : 0));  // what the rising edge is about to push out
      kClock.drive(true);
      half_period();
      kClock.drive(false);
    }
    in[byte] = got;
  }
}

void Stm32RouteChain::latch() {
  kLatch.drive(true);
  half_period();
  kLatch.drive(false);
  settle();
}

std::uint8_t Stm32RouteChain::stuck_lines() {
  std::uint8_t stuck = 0;
  for (unsigned l = 0; l < 4; ++l) {
    if (lines[l].low()) stuck = static_cast<std::uint8_t>(stuck | 1U << l);
  }
  return stuck;
}

}  // namespace triskin::board

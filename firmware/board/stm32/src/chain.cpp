// SPDX-License-Identifier: Apache-2.0
#include "chain.hpp"

#include "line.hpp"
#include "triskin/board/board.hpp"
#include "triskin/board/board_config.hpp"
#include "triskin/board/registers/spi.hpp"
#include "triskin/board/registers/system.hpp"

namespace triskin::board {
namespace {

constexpr Gpio kEnable{pins::kChainEnable}, kEnable2{pins::kChainEnable2}, kClock{pins::kChainClock},
    kDataIn{pins::kChainIn}, kDataOut{pins::kChainOut}, kLatch{pins::kChainLatch};
constexpr std::uint64_t kSettle_us = 5;

void settle() {
  const std::uint64_t end_us = microseconds() + kSettle_us + 1;
  while (microseconds() < end_us) {
  }
}

}  // namespace

Stm32RouteChain route_chain;

void Stm32RouteChain::open() {
  for (const Pin pin :
       {pins::kChainClock, pins::kChainIn, pins::kChainOut, pins::kChainEnable, pins::kChainEnable2, pins::kChainLatch})
    open_port(pin);
  rcc_reg::kApb1Enr1.set(rcc_reg::kSpi2);
  for (const Gpio& pin : {kEnable, kEnable2, kLatch}) {
    pin.drive(false);
    pin.mode(PinMode::kOutput);
  }
  kDataIn.pull_down();
  for (const Gpio& pin : {kClock, kDataIn, kDataOut}) {
    pin.alternate(pins::kFunctionSpi2);
    pin.mode(PinMode::kAlternate);
  }
  spi_reg::kCr2.write(spi_reg::kEightBits | spi_reg::kReceiveByte);
  const std::uint32_t control =
      spi_reg::kMaster | spi_reg::kClockBy64 | spi_reg::kSoftwareSelect | spi_reg::kInternalSelect;
  spi_reg::kCr1.write(control);
  spi_reg::kCr1.write(control | spi_reg::kEnable);
}

void Stm32RouteChain::enable(std::uint8_t cables) {
  kEnable.drive((cables & 1) != 0);
  kEnable2.drive((cables & 2) != 0);
  settle();
}

// One byte is in the shift register and the next one waits, so that the clock never pauses; the receiver holds four.
void Stm32RouteChain::exchange(Bytes out, std::span<std::uint8_t> in) {
  std::size_t sent = 0;
  for (std::size_t received = 0; received < out.size();) {
    if (sent < out.size() && sent < received + 2 && spi_reg::kSr.any(spi_reg::kRoom)) spi_reg::put(out[sent++]);
    if (spi_reg::kSr.any(spi_reg::kReceived)) in[received++] = spi_reg::get();
  }
  while (spi_reg::kSr.any(spi_reg::kBusy)) {
  }
}

// The stores and loads around the pulse make it longer than the 20 ns that the registers need.
void Stm32RouteChain::latch() {
  kLatch.drive(true);
  asm volatile("nop\n nop\n nop\n nop" ::: "memory");
  kLatch.drive(false);
  settle();
}

std::uint8_t Stm32RouteChain::stuck_lines() {
  std::uint8_t stuck = 0;
  for (unsigned l = 0; l < layout::kLines; ++l) {
    if (lines[l].low()) stuck = static_cast<std::uint8_t>(stuck | 1U << l);
  }
  return stuck;
}

}  // namespace triskin::board

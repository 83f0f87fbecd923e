// SPDX-License-Identifier: Apache-2.0
#include "serial.hpp"

#include "triskin/board/board_config.hpp"
#include "triskin/board/clock_plan.hpp"
#include "triskin/board/registers/gpio.hpp"
#include "triskin/board/registers/system.hpp"
#include "triskin/board/registers/usart.hpp"

namespace triskin::board {

using namespace usart_reg;

Stm32SerialPort serial;

namespace {

constexpr std::uint32_t kBaud = 115'200;
// With sixteen samples per bit, the divider is the clock divided by the baud rate (§40.5.7).
constexpr std::uint32_t kDivider = (kSysclk_hz + kBaud / 2) / kBaud;
static_assert(kDivider >= 16 && kDivider < 65536);

}  // namespace

void Stm32SerialPort::open() {
  open_port(pins::kLogSend);
  rcc_reg::kApb1Enr1.set(rcc_reg::kUsart2);
  (void)rcc_reg::kApb1Enr1.read();
  Gpio(pins::kLogSend).alternate(pins::kFunctionLog);
  Gpio(pins::kLogSend).mode(PinMode::kAlternate);
  kBrr.write(kDivider);
  kCr1.write(kFifo | kTransmit);
  kCr1.write(kFifo | kTransmit | kEnable);
}

bool Stm32SerialPort::send(std::uint8_t byte) {
  if (!kIsr.any(kRoom)) return false;
  kTdr.write(byte);
  return true;
}

}  // namespace triskin::board

// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/ports/ports.hpp"

namespace triskin::board {

/// The port is USART2 at 115,200 baud, 8 bits, no parity, which the ST-LINK of a Nucleo board shows as a serial port.
/// It only sends, from the FIFO of eight bytes, without interrupts.
class Stm32SerialPort final : public fw::SerialPort {
 public:
  void open();
  bool send(std::uint8_t byte) override;
};

extern Stm32SerialPort serial;

}  // namespace triskin::board

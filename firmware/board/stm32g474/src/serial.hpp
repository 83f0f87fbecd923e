// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/ports/ports.hpp"

namespace triskin::board {

/// USART2 at 115,200 baud, 8 bits, no parity: the ST-LINK of a Nucleo board makes a serial port of it. Only sends, from
/// the FIFO of eight bytes, without interrupts.
class Stm32SerialPort final : public fw::SerialPort {
 public:
  void open();
  bool send(std::uint8_t byte) override;
};

extern Stm32SerialPort serial;

}  // namespace triskin::board

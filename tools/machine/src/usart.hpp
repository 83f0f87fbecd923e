// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <deque>
#include <functional>
#include <string>

#include "triskin/machine/peripheral.hpp"

namespace triskin::machine {

/// Models the sender of USART2 with eight bits, no parity, one stop bit and its FIFO (RM0440 §40.5, §40.8). A baud
/// rate that is off by more than 2 % from 115,200 loses its text, as at a receiver that expects that rate.
class Usart final : public Peripheral {
 public:
  /// `pin_ready` tells that the sender's pin is at its alternate function; without a FIFO its bit is reserved.
  Usart(Surroundings& around, bool has_fifo, std::function<bool()> pin_ready)
      : Peripheral(around), has_fifo_(has_fifo), pin_ready_(std::move(pin_ready)) {}
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void reset() override;
  /// Returns the text that a terminal at 115,200 baud has shown since power-up.
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  static constexpr std::size_t kFifoBytes = 8;
  void write_control(std::uint32_t value);
  void put(std::uint8_t byte);
  void start_byte();
  void end_byte();
  [[nodiscard]] std::uint32_t status() const;

  bool has_fifo_;
  std::function<bool()> pin_ready_;
  std::uint32_t control_ = 0, divider_ = 0;
  std::deque<std::uint8_t> fifo_;
  bool shifting_ = false;
  std::string text_;
  std::uint64_t generation_ = 0;
};

}  // namespace triskin::machine

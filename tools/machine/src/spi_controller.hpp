// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <deque>
#include <functional>

#include "triskin/machine/peripheral.hpp"

namespace triskin::machine {

/// Models SPI2 as a master with frames of eight bits, mode 0, most significant bit first (RM0440 §42.5, §42.9): FIFOs
/// of 32 bits, the time of each frame, overrun. Any other setting is a violation.
class SpiController final : public Peripheral {
 public:
  /// `exchange` stands for the device at the wires: a byte out, a byte in. `pins_ready` tells that clock and data are
  /// alternate functions.
  SpiController(Surroundings& around, std::function<std::uint8_t(std::uint8_t)> exchange,
                std::function<bool()> pins_ready)
      : Peripheral(around), exchange_(std::move(exchange)), pins_ready_(std::move(pins_ready)) {}
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void reset() override;

 private:
  static constexpr std::size_t kFifoBytes = 4;
  void write_control(std::uint32_t value);
  void put(std::uint8_t byte);
  void start_frame();
  void end_frame(std::uint8_t byte);
  [[nodiscard]] std::uint32_t status() const;

  std::function<std::uint8_t(std::uint8_t)> exchange_;
  std::function<bool()> pins_ready_;
  std::uint32_t control1_ = 0, control2_ = 0x0700;
  std::deque<std::uint8_t> to_send_, received_;
  bool shifting_ = false, overrun_ = false;
  std::uint64_t generation_ = 0;
};

}  // namespace triskin::machine

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "triskin/sim/i2c_bus.hpp"

namespace triskin {

/// Simulates an I²C line on which nobody answers; both wires are high.
class QuietLine : public sim::I2cBus {
 public:
  bool start(std::uint8_t, std::uint64_t) override { return false; }
  bool write(std::uint8_t, std::uint64_t) override { return false; }
  std::uint8_t read(bool, std::uint64_t) override { return 0xFF; }
  void stop(std::uint64_t) override {}
  [[nodiscard]] bool scl() const override { return true; }
  [[nodiscard]] bool sda() const override { return true; }
  void pulse_scl(std::uint64_t) override {}
};

}  // namespace triskin

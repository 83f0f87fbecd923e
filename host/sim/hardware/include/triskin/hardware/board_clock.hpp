// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cmath>
#include <cstdint>
#include <optional>

#include "triskin/sim/i2c_bus.hpp"

namespace triskin::hardware {

/// Without a deviation, the clock of a virtual controller is equal to virtual time. With one, the clock starts at 0
/// when the board is powered, as in the microcontroller, and runs faster by the deviation.
class BoardClock {
 public:
  BoardClock() = default;
  /// `fast_ppm` says by how much the clock is faster than virtual time, in parts per million, above −10⁶.
  explicit BoardClock(double fast_ppm) : rate_(1.0 + fast_ppm * 1e-6) {}
  /// Notes that power is switched on at virtual time `now_us`.
  void power(std::uint64_t now_us) { powered_us_ = now_us; }
  /// Returns the clock's time at virtual time `now_us`, which must not be before power-up.
  [[nodiscard]] std::uint64_t shown_us(std::uint64_t now_us) const {
    if (!rate_) return now_us;
    return static_cast<std::uint64_t>(std::floor(static_cast<double>(now_us - powered_us_) * *rate_));
  }
  /// Returns the first µs of virtual time at which the clock shows `shown_us`; the end of time maps to itself.
  [[nodiscard]] std::uint64_t time_us(std::uint64_t shown_us) const {
    if (!rate_ || shown_us == UINT64_MAX) return shown_us;
    return powered_us_ + static_cast<std::uint64_t>(std::ceil(static_cast<double>(shown_us) / *rate_));
  }

 private:
  std::optional<double> rate_;
  std::uint64_t powered_us_ = 0;
};

/// A controller with its own clock drives the line, which passes virtual time to the chips.
class ClockedLine final : public sim::I2cBus {
 public:
  /// Both arguments must outlive the line.
  ClockedLine(sim::I2cBus& line, const BoardClock& clock) : line_(line), clock_(clock) {}
  bool start(std::uint8_t address_byte, std::uint64_t at_us) override {
    return line_.start(address_byte, clock_.time_us(at_us));
  }
  bool write(std::uint8_t byte, std::uint64_t at_us) override { return line_.write(byte, clock_.time_us(at_us)); }
  std::uint8_t read(bool acknowledge, std::uint64_t at_us) override {
    return line_.read(acknowledge, clock_.time_us(at_us));
  }
  void stop(std::uint64_t at_us) override { line_.stop(clock_.time_us(at_us)); }
  [[nodiscard]] bool scl() const override { return line_.scl(); }
  [[nodiscard]] bool sda() const override { return line_.sda(); }
  void pulse_scl(std::uint64_t at_us) override { line_.pulse_scl(clock_.time_us(at_us)); }

 private:
  sim::I2cBus& line_;
  const BoardClock& clock_;
};

}  // namespace triskin::hardware

// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/board/registers/register.hpp"

/// General-purpose pins, RM0440 §9.4.
namespace triskin::board {

struct Pin {
  char port;        ///< 'A', 'B', 'C'
  unsigned number;  ///< 0..15
};

enum class PinMode : std::uint32_t { kInput = 0, kOutput = 1, kAlternate = 2 };

class Gpio {
 public:
  /// The pin; its port must have its clock before any call below.
  constexpr explicit Gpio(Pin pin)
      : base_(0x48000000U + 0x400U * static_cast<unsigned>(pin.port - 'A')), n_(pin.number) {}
  /// Input, output or alternate function. Interrupts must not change pins of the same port meanwhile.
  void mode(PinMode mode) const {
    Register(base_).modify(3U << (2 * n_), static_cast<std::uint32_t>(mode) << (2 * n_));
  }
  /// The pin only pulls low; the line's resistor pulls it high.
  void open_drain() const { Register(base_ + 0x04).set(bit(n_)); }
  /// Internal pull-down, about 40 kΩ.
  void pull_down() const { Register(base_ + 0x0C).modify(3U << (2 * n_), 2U << (2 * n_)); }
  /// Steepest edges; for clocks above some MHz.
  void very_high_speed() const { Register(base_ + 0x08).set(3U << (2 * n_)); }
  /// Chooses the alternate function 0..15 (data sheet, pin table).
  void alternate(std::uint32_t function) const {
    const unsigned shift = 4 * (n_ % 8);
    Register(base_ + (n_ < 8 ? 0x20 : 0x24)).modify(0xFU << shift, function << shift);
  }
  /// True when the pin is high, whoever drives it.
  [[nodiscard]] bool level() const { return Register(base_ + 0x10).any(bit(n_)); }
  /// Drives the output high (true) or low, in one write that leaves other pins alone.
  void drive(bool high) const { Register(base_ + 0x18).write(high ? bit(n_) : bit(n_ + 16)); }

 private:
  std::uint32_t base_;
  unsigned n_;
};

}  // namespace triskin::board

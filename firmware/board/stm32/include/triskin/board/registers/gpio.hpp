// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "triskin/board/registers/register.hpp"

/// RM0440 §9.4 describes the general-purpose pins.
namespace triskin::board {

namespace gpio_reg {
inline constexpr std::uint32_t kBase = 0x48000000, kStride = 0x400;
inline constexpr std::uint32_t kModer = 0x00, kOtyper = 0x04, kOspeedr = 0x08, kPupdr = 0x0C, kIdr = 0x10, kBsrr = 0x18,
                               kAfrl = 0x20, kAfrh = 0x24;
// Each field has two bits.
inline constexpr std::uint32_t kFieldMask = 3, kPullUp = 1, kPullDown = 2, kVeryHighSpeed = 3;
// In BSRR, the bit that resets a pin is this much higher than the one that sets it.
inline constexpr std::uint32_t kResetShift = 16;
}  // namespace gpio_reg

struct Pin {
  char port;        ///< Ports are named 'A' to 'H'.
  unsigned number;  ///< Valid values are 0 to 15.
};

enum class PinMode : std::uint32_t { kInput = 0, kOutput = 1, kAlternate = 2 };

class Gpio {
 public:
  /// Represents a pin; its port must be clocked before any call below.
  constexpr explicit Gpio(Pin pin)
      : base_(gpio_reg::kBase + gpio_reg::kStride * static_cast<unsigned>(pin.port - 'A')), n_(pin.number) {}
  /// Selects input, output or alternate function. Interrupts must not change pins of the same port at the same time.
  void mode(PinMode mode) const { field(gpio_reg::kModer, static_cast<std::uint32_t>(mode)); }
  /// Returns true in analog mode, as after a reset, in which the input reads 0.
  [[nodiscard]] bool analog() const {
    return (Register(base_ + gpio_reg::kModer).read() >> (2 * n_) & gpio_reg::kFieldMask) == gpio_reg::kFieldMask;
  }
  /// Makes the pin only pull low; the line's resistor pulls it high.
  void open_drain() const { Register(base_ + gpio_reg::kOtyper).set(bit(n_)); }
  /// Enables the internal pull-up, about 40 kΩ.
  void pull_up() const { field(gpio_reg::kPupdr, gpio_reg::kPullUp); }
  /// Enables the internal pull-down, about 40 kΩ.
  void pull_down() const { field(gpio_reg::kPupdr, gpio_reg::kPullDown); }
  /// Selects the steepest edges, for clocks above some MHz.
  void very_high_speed() const { field(gpio_reg::kOspeedr, gpio_reg::kVeryHighSpeed); }
  /// Selects the alternate function 0..15 (data sheet, pin table).
  void alternate(std::uint32_t function) const {
    const unsigned shift = 4 * (n_ % 8);
    Register(base_ + (n_ < 8 ? gpio_reg::kAfrl : gpio_reg::kAfrh)).modify(0xFU << shift, function << shift);
  }
  /// Returns true when the pin is high, whoever drives it.
  [[nodiscard]] bool level() const { return Register(base_ + gpio_reg::kIdr).any(bit(n_)); }
  /// Drives the output high (true) or low, in one write that does not affect other pins.
  void drive(bool high) const {
    Register(base_ + gpio_reg::kBsrr).write(high ? bit(n_) : bit(n_ + gpio_reg::kResetShift));
  }

 private:
  void field(std::uint32_t offset, std::uint32_t value) const {
    Register(base_ + offset).modify(gpio_reg::kFieldMask << (2 * n_), value << (2 * n_));
  }
  std::uint32_t base_;
  unsigned n_;
};

}  // namespace triskin::board

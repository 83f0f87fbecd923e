// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <random>

#include "triskin/machine/machine.hpp"
#include "triskin/machine/peripheral.hpp"
#include "triskin/machine/route_chain_pins.hpp"
#include "triskin/machine/system_blocks.hpp"
#include "triskin/sim/i2c_bus.hpp"

namespace triskin::machine {

/// Models ports A, B, C (RM0440 §9.4): modes, alternate functions, levels. The pins of the four I²C lines are tied to
/// their buses, so that pulses made by hand reach the chips; PB12, PB10 and PB11 are EN and latch of the route chain.
class Gpio final : public Peripheral {
 public:
  Gpio(Surroundings& around, ClockControl& rcc, const std::array<sim::I2cBus*, 4>& buses, RouteChainPins& chain,
       const BoardPins& pins = {})
      : Peripheral(around), rcc_(rcc), buses_(buses), chain_(chain), pins_(pins) {}
  std::uint32_t read(std::uint32_t offset, unsigned size) override;
  void write(std::uint32_t offset, std::uint32_t value, unsigned size) override;
  void reset() override;
  /// Returns true if the pin is at an alternate function; port 0 is A.
  [[nodiscard]] bool alternate(unsigned port, unsigned pin, unsigned function) const;
  /// Returns true if SCL and SDA of a line are open drain and belong to its I²C block.
  [[nodiscard]] bool line_ready(std::size_t line) const;
  [[nodiscard]] bool can_ready() const;
  [[nodiscard]] bool log_ready() const;
  /// Returns true if clock and data of the route chain belong to SPI2.
  [[nodiscard]] bool chain_ready() const;
  void hold_button(bool pressed) { button_ = pressed; }
  void set_boot_pin(bool high) { boot_pin_high_ = high; }

 private:
  struct Port {
    std::uint32_t moder = 0xFFFFFFFF, otyper = 0, ospeedr = 0, pupdr = 0, odr = 0, afrl = 0, afrh = 0;
  };
  struct LinePins {
    unsigned scl_port, scl, sda_port, sda;
  };
  [[nodiscard]] LinePins pins_of(std::size_t line) const {
    const BoardPins::Line& l = pins_.lines[line];
    return {l.scl.port, l.scl.number, l.sda.port, l.sda.number};
  }
  [[nodiscard]] bool drives_low(unsigned port, unsigned pin) const;
  [[nodiscard]] std::uint32_t levels(unsigned port);
  [[nodiscard]] std::uint32_t floating(unsigned port) const;
  [[nodiscard]] bool drives_high(unsigned port, unsigned pin) const;
  void follow_lines(const std::array<Port, 3>& before);
  void follow_chain();
  void follow_pulls();

  ClockControl& rcc_;
  std::array<sim::I2cBus*, 4> buses_;
  RouteChainPins& chain_;
  BoardPins pins_;
  std::uint8_t cables_ = 0;
  bool latch_high_ = false, boot_pin_high_ = true, button_ = false;
  std::array<Port, 3> ports_;
  std::mt19937 noise_{20261127};  // Inputs that nothing pulls or drives read as these bits.
};

}  // namespace triskin::machine

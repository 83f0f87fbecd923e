// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/machine/gpio.hpp"

#include <fmt/format.h>

#include <utility>

#include "triskin/machine/map.hpp"

namespace triskin::machine {
// Pins float at a reset; the patch has pull-downs on EN and latch.
void Gpio::reset() {
  ports_ = {};
  // PA13, PA14, PA15, PB3 and PB4 belong to the debugger (RM0440 §9.4.1 … §9.4.4).
  ports_[0].moder = 0xABFFFFFF;
  ports_[0].ospeedr = 0x0C000000;
  ports_[0].pupdr = 0x64000000;
  ports_[1].moder = 0xFFFFFEBF;
  ports_[1].ospeedr = 0x000000C0;
  ports_[1].pupdr = 0x00000100;
  follow_pulls();
  follow_chain();
}

bool Gpio::drives_high(unsigned port, unsigned pin) const {
  const Port& p = ports_[port];
  return (p.moder >> (2 * pin) & 3) == 1 && (p.odr >> pin & 1) == 1;
}

bool Gpio::alternate(unsigned port, unsigned pin, unsigned function) const {
  const Port& p = ports_[port];
  return (p.moder >> (2 * pin) & 3) == 2 && ((pin < 8 ? p.afrl : p.afrh) >> (4 * (pin % 8)) & 15) == function;
}

bool Gpio::log_ready() const {
  return alternate(pins_.log.port, pins_.log.number, map::kFunctionUsart2);
}

bool Gpio::chain_ready() const {
  constexpr unsigned kPortB = 1;
  return alternate(kPortB, 13, map::kFunctionSpi2) && alternate(kPortB, 14, map::kFunctionSpi2) &&
         alternate(kPortB, 15, map::kFunctionSpi2);
}

bool Gpio::line_ready(std::size_t line) const {
  const LinePins l = pins_of(line);
  const unsigned function = pins_.line_functions[line];
  const bool open_drain =
      (ports_[l.scl_port].otyper >> l.scl & 1) != 0 && (ports_[l.sda_port].otyper >> l.sda & 1) != 0;
  return open_drain && alternate(l.scl_port, l.scl, function) && alternate(l.sda_port, l.sda, function);
}

bool Gpio::can_ready() const {
  return alternate(pins_.can_receive.port, pins_.can_receive.number, map::kFunctionCan) &&
         alternate(pins_.can_send.port, pins_.can_send.number, map::kFunctionCan);
}

void Gpio::follow_chain() {
  const auto cables = static_cast<std::uint8_t>((drives_high(1, 12) ? 1 : 0) | (drives_high(1, 10) ? 2 : 0));
  if (cables != std::exchange(cables_, cables)) chain_.enable(cables);
  if (const bool high = drives_high(1, 11); !std::exchange(latch_high_, high) && high) chain_.latch();
}

bool Gpio::drives_low(unsigned port, unsigned pin) const {
  const Port& p = ports_[port];
  return (p.moder >> (2 * pin) & 3) == 1 && (p.odr >> pin & 1) == 0;
}

// The pins that nothing pulls or drives: inputs and open-drain outputs that are released, without a pull of the chip.
// Lines, button, boot pin and CAN receiver are tied to something outside; an output of a block counts as driven.
std::uint32_t Gpio::floating(unsigned port) const {
  const Port& p = ports_[port];
  std::uint32_t pins = 0;
  for (unsigned pin = 0; pin < 16; ++pin) {
    const unsigned mode = p.moder >> (2 * pin) & 3;
    const bool released = mode == 0 || (mode == 1 && (p.otyper >> pin & 1) != 0 && (p.odr >> pin & 1) != 0);
    if (released && (p.pupdr >> (2 * pin) & 3) == 0) pins |= 1U << pin;
  }
  const auto tie = [&](unsigned tied_port, unsigned pin) {
    if (tied_port == port) pins &= ~(1U << pin);
  };
  tie(2, 13);
  tie(1, 8);
  tie(pins_.can_receive.port, pins_.can_receive.number);
  for (std::size_t k = 0; k < buses_.size(); ++k) {
    const LinePins l = pins_of(k);
    tie(l.scl_port, l.scl);
    tie(l.sda_port, l.sda);
  }
  return pins;
}

std::uint32_t Gpio::levels(unsigned port) {
  const std::uint32_t open = floating(port);
  std::uint32_t v = 0xFFFF;
  if (open != 0) v &= ~(open & static_cast<std::uint32_t>(noise_()));
  if (port == 2 && !button_) v &= ~(1U << 13);
  for (unsigned pin = 0; pin < 16; ++pin) {
    if (drives_low(port, pin)) v &= ~(1U << pin);
  }
  if (port == 1 && !boot_pin_high_) v &= ~(1U << 8);
  for (std::size_t k = 0; k < buses_.size(); ++k) {
    const LinePins l = pins_of(k);
    if (l.scl_port == port && !buses_[k]->scl()) v &= ~(1U << l.scl);
    if (l.sda_port == port && !buses_[k]->sda()) v &= ~(1U << l.sda);
  }
  return v;
}

std::uint32_t Gpio::read(std::uint32_t offset, unsigned) {
  const unsigned port = offset / 0x400;
  if (port >= ports_.size()) return 0;
  const Port& p = ports_[port];
  switch (offset % 0x400) {
    case 0x00:
      return p.moder;
    case 0x04:
      return p.otyper;
    case 0x08:
      return p.ospeedr;
    case 0x0C:
      return p.pupdr;
    case 0x10:
      return levels(port);
    case 0x14:
      return p.odr;
    case 0x20:
      return p.afrl;
    case 0x24:
      return p.afrh;
    default:
      return 0;
  }
}

// A line without pull-ups of its own floats unless the chip pulls it up.
void Gpio::follow_pulls() {
  const auto up = [this](unsigned port, unsigned pin) { return (ports_[port].pupdr >> (2 * pin) & 3) == 1; };
  for (std::size_t k = 0; k < buses_.size(); ++k) {
    const LinePins l = pins_of(k);
    buses_[k]->controller_pulls_up(up(l.scl_port, l.scl) && up(l.sda_port, l.sda));
  }
}

// A rising SCL is one pulse; a rising SDA while SCL is high is a stop.
void Gpio::follow_lines(const std::array<Port, 3>& before) {
  const std::array<Port, 3> after = ports_;
  for (std::size_t k = 0; k < buses_.size(); ++k) {
    const LinePins l = pins_of(k);
    ports_ = before;
    const bool scl_was_low = drives_low(l.scl_port, l.scl), sda_was_low = drives_low(l.sda_port, l.sda);
    ports_ = after;
    const bool scl_low = drives_low(l.scl_port, l.scl), sda_low = drives_low(l.sda_port, l.sda);
    if (scl_was_low && !scl_low) buses_[k]->pulse_scl(around_.time().now_us());
    if (sda_was_low && !sda_low && !scl_low) buses_[k]->stop(around_.time().now_us());
  }
}

void Gpio::write(std::uint32_t offset, std::uint32_t value, unsigned) {
  const unsigned port = offset / 0x400;
  if (port >= ports_.size()) return;
  if (!rcc_.enabled(0x4C, port)) {
    around_.violation(fmt::format("GPIO{} written without its clock", static_cast<char>('A' + port)));
    return;
  }
  const std::array<Port, 3> before = ports_;
  Port& p = ports_[port];
  switch (offset % 0x400) {
    case 0x00:
      p.moder = value;
      break;
    case 0x04:
      p.otyper = value;
      break;
    case 0x08:
      p.ospeedr = value;
      break;
    case 0x0C:
      p.pupdr = value;
      break;
    case 0x14:
      p.odr = value & 0xFFFF;
      break;
    case 0x18:
      p.odr = (p.odr | (value & 0xFFFF)) & ~(value >> 16 & ~value & 0xFFFF);
      break;
    case 0x20:
      p.afrl = value;
      break;
    case 0x24:
      p.afrh = value;
      break;
    default:
      around_.violation(fmt::format("GPIO register {:#x} is not modelled", offset % 0x400));
  }
  follow_pulls();
  follow_lines(before);
  follow_chain();
}

}  // namespace triskin::machine

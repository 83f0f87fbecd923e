// SPDX-License-Identifier: GPL-3.0-or-later
#include "usart.hpp"

#include <fmt/format.h>

#include <cmath>

namespace triskin::machine {
namespace {

constexpr std::uint32_t kEnable = 1U << 0, kTransmit = 1U << 3, kFifo = 1U << 29,
                        kOthers = ~(kEnable | kTransmit | kFifo);
constexpr double kBaud = 115'200, kTolerance = 0.02;
constexpr std::uint64_t kBitsOfByte = 10;

}  // namespace

// A reset ends the byte under way.
void Usart::reset() {
  control_ = divider_ = 0;
  fifo_.clear();
  shifting_ = false;
  ++generation_;
}

std::uint32_t Usart::status() const {
  const bool room = fifo_.size() < ((control_ & kFifo) != 0 ? kFifoBytes : 1);
  const bool complete = fifo_.empty() && !shifting_;
  return (complete ? 1U << 6 : 0U) | (room ? 1U << 7 : 0U);
}

std::uint32_t Usart::read(std::uint32_t offset, unsigned) {
  switch (offset) {
    case 0x00:
      return control_;
    case 0x0C:
      return divider_;
    case 0x1C:
      return status();
    default:
      around_.violation(fmt::format("USART register {:#x} is not modelled", offset));
      return 0;
  }
}

void Usart::write(std::uint32_t offset, std::uint32_t value, unsigned) {
  switch (offset) {
    case 0x00:
      return write_control(value);
    case 0x0C:
      if ((control_ & kEnable) != 0) around_.violation("USART_BRR written while the USART is on");
      if (value < 16) around_.violation("USART_BRR below 16");
      divider_ = value;
      return;
    case 0x28:
      return put(static_cast<std::uint8_t>(value));
    default:
      around_.violation(fmt::format("USART register {:#x} is not modelled", offset));
  }
}

void Usart::write_control(std::uint32_t value) {
  if ((value & kFifo) != 0 && !has_fifo_) around_.violation("USART_CR1 bit 29 set: this USART has no FIFO");
  if ((value & kOthers) != 0) around_.violation("USART: only a sender of eight bits without interrupts is modelled");
  if ((control_ & kEnable) != 0 && ((value ^ control_) & kFifo) != 0)
    around_.violation("USART_CR1.FIFOEN changed while the USART is on");
  control_ = value;
}

void Usart::put(std::uint8_t byte) {
  if ((control_ & (kEnable | kTransmit)) != (kEnable | kTransmit))
    return around_.violation("USART data written while its sender is off");
  if ((status() & 1U << 7) == 0) return around_.violation("USART data written into a full FIFO");
  fifo_.push_back(byte);
  if (!shifting_) start_byte();
}

void Usart::start_byte() {
  shifting_ = true;
  around_.time().after(kBitsOfByte * divider_ * kSecond / around_.sysclk_hz(), [this, g = generation_] {
    if (g == generation_) end_byte();
  });
}

void Usart::end_byte() {
  const double baud = static_cast<double>(around_.sysclk_hz()) / divider_;
  if (!pin_ready_()) around_.violation("USART sends, but its pin is no alternate function");
  text_ += std::abs(baud / kBaud - 1) < kTolerance ? static_cast<char>(fifo_.front()) : '?';
  fifo_.pop_front();
  shifting_ = false;
  if (!fifo_.empty()) start_byte();
}

}  // namespace triskin::machine

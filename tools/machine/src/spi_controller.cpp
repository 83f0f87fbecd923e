// SPDX-License-Identifier: GPL-3.0-or-later
#include "spi_controller.hpp"

#include <fmt/format.h>

#include <utility>

namespace triskin::machine {
namespace {

constexpr std::uint32_t kMaster = 1U << 2, kEnable = 1U << 6, kPhasePolarity = 3, kMinFirst = 1U << 7,
                        kSelectedHigh = 3U << 8;
constexpr std::uint32_t kDataSize = 15U << 8, kEightBits = 7U << 8, kReceiveByte = 1U << 12;

}  // namespace

void SpiController::reset() {
  control1_ = 0;
  control2_ = 0x0700;
  to_send_.clear();
  received_.clear();
  shifting_ = overrun_ = false;
  ++generation_;
}

std::uint32_t SpiController::status() const {
  const bool room = to_send_.size() <= kFifoBytes / 2;
  return (received_.empty() ? 0U : 1U) | (room ? 2U : 0U) | (overrun_ ? 1U << 6 : 0U) | (shifting_ ? 1U << 7 : 0U);
}

std::uint32_t SpiController::read(std::uint32_t offset, unsigned size) {
  switch (offset) {
    case 0x00:
      return control1_;
    case 0x04:
      return control2_;
    case 0x08:
      return status();
    case 0x0C:
      break;
    default:
      around_.violation(fmt::format("SPI register {:#x} is not modelled", offset));
      return 0;
  }
  if (size != 1) around_.violation("SPI data read wider than a frame: that takes two");
  if (received_.empty()) {
    around_.violation("SPI data read while nothing was received");
    return 0;
  }
  const std::uint8_t byte = received_.front();
  received_.pop_front();
  return byte;
}

void SpiController::write(std::uint32_t offset, std::uint32_t value, unsigned size) {
  switch (offset) {
    case 0x00:
      return write_control(value);
    case 0x04:
      if ((control1_ & kEnable) != 0) around_.violation("SPI_CR2 changed while SPI is on");
      control2_ = value;
      return;
    case 0x0C:
      if (size != 1) around_.violation("SPI data written wider than a frame: that sends two");
      return put(static_cast<std::uint8_t>(value));
    default:
      around_.violation(fmt::format("SPI register {:#x} is not modelled", offset));
  }
}

void SpiController::write_control(std::uint32_t value) {
  const std::uint32_t changed = value ^ control1_;
  if ((control1_ & kEnable) != 0 && (changed & ~kEnable) != 0) around_.violation("SPI_CR1 changed while SPI is on");
  if ((changed & kEnable) != 0 && (value & kEnable) == 0 && shifting_)
    around_.violation("SPI switched off while it is busy");
  control1_ = value;
  if ((value & kEnable) == 0) return;
  if ((value & kMaster) == 0 || (value & (kPhasePolarity | kMinFirst)) != 0)
    around_.violation("SPI: only a master in mode 0, most significant bit first, is modelled");
  if ((value & kSelectedHigh) != kSelectedHigh)
    around_.violation("SPI: a master without NSS pin needs SSM and SSI, or it faults (MODF)");
  if ((control2_ & kDataSize) != kEightBits || (control2_ & kReceiveByte) == 0)
    around_.violation("SPI: only frames of eight bits with FRXTH are modelled");
}

void SpiController::put(std::uint8_t byte) {
  if ((control1_ & kEnable) == 0) return around_.violation("SPI data written while SPI is off");
  if (to_send_.size() == kFifoBytes) return around_.violation("SPI data written into a full FIFO");
  to_send_.push_back(byte);
  if (!shifting_) start_frame();
}

void SpiController::start_frame() {
  shifting_ = true;
  const std::uint8_t byte = to_send_.front();
  to_send_.pop_front();
  const std::uint64_t clock_hz = around_.sysclk_hz() >> ((control1_ >> 3 & 7) + 1);
  around_.time().after(8 * kSecond / clock_hz, [this, byte, generation = generation_] {
    if (generation == generation_) end_frame(byte);
  });
}

void SpiController::end_frame(std::uint8_t byte) {
  if (!pins_ready_()) around_.violation("SPI sends, but its pins are not alternate functions");
  const std::uint8_t in = exchange_(byte);
  if (received_.size() < kFifoBytes)
    received_.push_back(in);
  else
    overrun_ = true, around_.violation("SPI overrun: four bytes were not read");
  shifting_ = false;
  if (!to_send_.empty()) start_frame();
}

}  // namespace triskin::machine

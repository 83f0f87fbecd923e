// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/machine/fdcan.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "triskin/machine/map.hpp"

namespace triskin::machine {
namespace {

constexpr std::uint32_t kDbtp = 0x0C, kCccr = 0x18, kNbtp = 0x1C, kTdcr = 0x48, kIr = 0x50, kIe = 0x54, kIle = 0x5C,
                        kRxgfc = 0x80, kTxbc = 0xC0;
constexpr std::uint32_t kFifo0 = 0x0B0, kTx = 0x278, kElement = 72, kExtFilters = 0x070;
constexpr std::array<std::uint8_t, 16> kSizes{0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};
constexpr std::uint32_t kNewMessage = 1, kFull = 2, kLost = 4, kTxDone = 1U << 7, kPassiveChanged = 1U << 17,
                        kWarningChanged = 1U << 18, kOffChanged = 1U << 19, kRamFailed = 1U << 14;
constexpr std::uint32_t kRestricted = 1U << 2;  // CCCR.ASM

}  // namespace

void Fdcan::reset() {
  reset_bus();
  regs_ = {};
  regs_[kCccr / 4] = 1;
  regs_[kNbtp / 4] = 0x06000A03;
  regs_[kDbtp / 4] = 0x00000A33;
  to_send_.clear();
  fill_ = get_ = put_ = tx_put_ = 0;
  update_irqs();
}

void Fdcan::update_irqs() {
  around_.set_irq(map::kFdcanIrq, (regs_[kIr / 4] & regs_[kIe / 4]) != 0 && (regs_[kIle / 4] & 1) != 0);
}

Time Fdcan::bit_time(bool data_phase) const {
  const std::uint32_t n = regs_[kNbtp / 4], d = regs_[kDbtp / 4];
  const Time clock = kSecond / around_.sysclk_hz();
  if (data_phase) return ((d >> 16 & 31) + 1) * ((d >> 8 & 31) + 1 + (d >> 4 & 15) + 1 + 1) * clock;
  return ((n >> 16 & 511) + 1) * ((n >> 8 & 255) + 1 + (n & 127) + 1 + 1) * clock;
}

// At bus-off the block sets INIT by itself, and may return once INIT is cleared.
void Fdcan::note_state(const State& before) {
  const State now = state();
  if (now.off) {
    regs_[kCccr / 4] |= 1;
    regs_[kIr / 4] |= kOffChanged;
    return;
  }
  if (now.passive != before.passive) regs_[kIr / 4] |= kPassiveChanged;
  if (now.warning != before.warning) regs_[kIr / 4] |= kWarningChanged;
}

// PSR reports error passive, warning and bus-off.
std::uint32_t Fdcan::protocol_status() const {
  const State s = state();
  return (s.passive ? 1U << 5 : 0U) | (s.warning ? 1U << 6 : 0U) | (s.off ? 1U << 7 : 0U);
}

// In restricted operation mode the block receives and acknowledges, but sends nothing until the program leaves the
// mode (§44.3.3).
void Fdcan::fail_ram() {
  regs_[kCccr / 4] |= kRestricted;
  regs_[kIr / 4] |= kRamFailed;
  update_irqs();
}

wire::CanFrame Fdcan::read_element(std::uint32_t offset) const {
  const std::uint32_t w0 = ram_[offset / 4], w1 = ram_[offset / 4 + 1];
  wire::CanFrame f;
  f.extended = (w0 >> 30 & 1) != 0;
  f.id = f.extended ? w0 & 0x1FFFFFFF : w0 >> 18 & 0x7FF;
  f.fd = (w1 >> 21 & 1) != 0 && (regs_[kCccr / 4] >> 8 & 1) != 0;
  f.bit_rate_switch = f.fd && (w1 >> 20 & 1) != 0 && (regs_[kCccr / 4] >> 9 & 1) != 0;
  f.size = kSizes[w1 >> 16 & 15];
  if (!f.fd) f.size = std::min<std::uint8_t>(f.size, 8);
  for (std::uint32_t k = 0; k < f.size; ++k)
    f.data[k] = static_cast<std::uint8_t>(ram_[offset / 4 + 2 + k / 4] >> (8 * (k % 4)));
  return f;
}

void Fdcan::write_element(std::uint32_t offset, const wire::CanFrame& f) {
  std::uint32_t code = 0;
  while (kSizes[code] < f.size) ++code;
  ram_[offset / 4] = f.extended ? 1U << 30 | f.id : f.id << 18;
  ram_[offset / 4 + 1] = code << 16 | (f.fd ? 1U << 21 : 0U) | (f.bit_rate_switch ? 1U << 20 : 0U);
  for (std::uint32_t k = 0; k < 16; ++k) {
    std::uint32_t w = 0;
    for (std::uint32_t b = 0; b < 4; ++b) w |= static_cast<std::uint32_t>(f.data[4 * k + b]) << (8 * b);
    ram_[offset / 4 + 2 + k] = w;
  }
}

// Applies the classic filters (identifier and mask) into FIFO 0, then the rule of RXGFC for all other frames.
bool Fdcan::accepted(const wire::CanFrame& f) const {
  const std::uint32_t rxgfc = regs_[kRxgfc / 4];
  const std::uint32_t count = f.extended ? rxgfc >> 24 & 15 : rxgfc >> 16 & 31;
  for (std::uint32_t k = 0; k < count; ++k) {
    if (f.extended) {
      const std::uint32_t f0 = ram_[kExtFilters / 4 + 2 * k], f1 = ram_[kExtFilters / 4 + 2 * k + 1];
      if ((f1 >> 30) == 2 && (f0 >> 29) == 1 && (f.id & f1 & 0x1FFFFFFF) == (f0 & f1 & 0x1FFFFFFF)) return true;
    } else {
      const std::uint32_t e = ram_[k];
      if ((e >> 30) == 2 && (e >> 27 & 7) == 1 && (f.id & e & 0x7FF) == (e >> 16 & e & 0x7FF)) return true;
    }
  }
  return (f.extended ? rxgfc >> 2 & 3 : rxgfc >> 4 & 3) == 0;
}

void Fdcan::deliver(const wire::CanFrame& frame) {
  if (!running() || !accepted(frame)) return;
  if (frame.fd && (regs_[kCccr / 4] >> 8 & 1) == 0) return;  // The real bus would see an error frame.
  if (fill_ == 3) {
    regs_[kIr / 4] |= kLost;
  } else {
    write_element(kFifo0 + put_ * kElement, frame);
    put_ = (put_ + 1) % 3;
    regs_[kIr / 4] |= ++fill_ == 3 ? kNewMessage | kFull : kNewMessage;
  }
  update_irqs();
}

std::optional<wire::CanFrame> Fdcan::next_to_send() const {
  if (to_send_.empty() || (regs_[kCccr / 4] & kRestricted) != 0) return std::nullopt;
  return read_element(kTx + to_send_.front() * kElement);
}

void Fdcan::note_sent() {
  const std::uint32_t index = to_send_.front();
  to_send_.pop_front();
  regs_[0xC8 / 4] &= ~(1U << index);
  regs_[0xD4 / 4] |= 1U << index;
  if ((regs_[0xDC / 4] >> index & 1) != 0) regs_[kIr / 4] |= kTxDone;
}

void Fdcan::request(std::uint32_t mask) {
  if (!running()) {
    around_.violation("FDCAN: transmission requested in initialization mode");
    return;
  }
  for (std::uint32_t k = 0; k < 3; ++k) {
    if ((mask >> k & 1) == 0) continue;
    if (k != tx_put_) around_.violation("FDCAN: a transmit FIFO element out of order");
    regs_[0xC8 / 4] |= 1U << k;
    regs_[0xD4 / 4] &= ~(1U << k);
    to_send_.push_back(k);
    tx_put_ = (k + 1) % 3;
  }
  next_on_bus();
}

// M_CAN allows transmitter delay compensation with a data prescaler of 1 or 2 only.
void Fdcan::check_start() {
  const std::uint32_t data = regs_[kDbtp / 4];
  if ((data >> 23 & 1) != 0 && (data >> 16 & 31) > 1)
    around_.violation(fmt::format("FDCAN: delay compensation with a data prescaler of {}", (data >> 16 & 31) + 1));
  if (!pins_ready_()) around_.violation("FDCAN started while PB8 or PB9 is not its alternate function");
}

std::uint32_t Fdcan::read(std::uint32_t offset, unsigned) {
  if (offset == 0x00) return 0x32141218;  // The register is CREL.
  if (offset == 0x04) return 0x87654321;  // The register is ENDN.
  if (offset == 0x40)
    return send_errors() | std::min(receive_errors(), 127U) << 8 | (receive_errors() > 127 ? 1U << 15 : 0U);
  if (offset == 0x44) return protocol_status();
  if (offset == 0x90) return fill_ | get_ << 8 | put_ << 16 | (fill_ == 3 ? 1U << 24 : 0U);
  if (offset == 0xC4) {
    const auto waiting = static_cast<std::uint32_t>(to_send_.size());
    return (3 - waiting) | (to_send_.empty() ? tx_put_ : to_send_.front()) << 8 | tx_put_ << 16 |
           (waiting == 3 ? 1U << 21 : 0U);
  }
  return offset / 4 < regs_.size() ? regs_[offset / 4] : 0;
}

void Fdcan::write(std::uint32_t offset, std::uint32_t value, unsigned) {
  const bool configuration =
      offset == kDbtp || offset == kNbtp || offset == kTdcr || offset == kRxgfc || offset == kTxbc || offset == 0x100;
  if (configuration && (regs_[kCccr / 4] & 3) != 3) {
    around_.violation(fmt::format("FDCAN: register {:#x} written without INIT and CCE", offset));
    return;
  }
  switch (offset) {
    case kCccr: {
      std::uint32_t& cccr = regs_[kCccr / 4];
      if ((value & 0x300) != (cccr & 0x300) && (cccr & 3) != 3)
        around_.violation("FDCAN: FDOE or BRSE changed without INIT and CCE");
      if ((value & ~cccr & kRestricted) != 0 && (cccr & 3) != 3)
        around_.violation("FDCAN: restricted operation mode set without INIT and CCE");
      if ((value & 1) == 0 && (cccr & 1) != 0) check_start();
      if ((value & 1) == 0 && bus_off()) rejoin();
      cccr = (value & 1) == 0 ? value & ~2U : value;
      break;
    }
    case kIr:
      regs_[kIr / 4] &= ~value;
      break;
    case 0x94:
      if (fill_ == 0 || (value & 3) != get_)
        around_.violation("FDCAN: acknowledged a FIFO element that is not the oldest");
      else {
        get_ = (get_ + 1) % 3;
        --fill_;
      }
      break;
    case 0xCC:
      request(value & 7);
      break;
    default:
      if (offset / 4 < regs_.size()) regs_[offset / 4] = value;
  }
  update_irqs();
  next_on_bus();
}

}  // namespace triskin::machine

// SPDX-License-Identifier: GPL-3.0-or-later
#include "usb_controller.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "triskin/machine/map.hpp"

namespace triskin::machine {
namespace {

constexpr std::uint32_t kReset = 1U << 10, kSuspend = 1U << 11, kWakeUp = 1U << 12, kTransferred = 1U << 15;
constexpr std::uint32_t kReceived = 1U << 15, kSetup = 1U << 11, kSent = 1U << 7, kPlain = 0x70F,
                        kReceiveToggle = 1U << 14, kSendToggle = 1U << 6;
constexpr std::uint32_t kToggled = kReceiveToggle | 3U << 12 | kSendToggle | 3U << 4;
constexpr std::uint32_t kDisabled = 0, kStall = 1, kNak = 2, kValid = 3;
constexpr std::uint32_t kSendAddress = 0, kSendCount = 1, kReceiveAddress = 2, kReceiveCount = 3;
constexpr Time kStartUp = 1 * kMicrosecond;  // The time is from the STM32G474 data sheet, USB start-up time.

std::uint32_t receive_status(std::uint32_t r) {
  return r >> 12 & 3;
}
std::uint32_t send_status(std::uint32_t r) {
  return r >> 4 & 3;
}
void set_receive_status(std::uint32_t& r, std::uint32_t s) {
  r = (r & ~(3U << 12)) | s << 12;
}
void set_send_status(std::uint32_t& r, std::uint32_t s) {
  r = (r & ~(3U << 4)) | s << 4;
}
bool control_type(std::uint32_t r) {
  return (r >> 9 & 3) == 1;
}

}  // namespace

void UsbController::reset() {
  endpoints_ = {};
  control_ = 3;
  events_ = address_ = table_ = 0;
  pull_up_ = false;
  powered_ = kNever;
  update_irq();
}

std::uint32_t UsbController::status() const {
  std::uint32_t s = events_;
  for (std::size_t n = kEndpoints; n-- > 0;) {
    if ((endpoints_[n] & (kReceived | kSent)) == 0) continue;
    s = (s & ~0x1FU) | kTransferred | static_cast<std::uint32_t>(n) | ((endpoints_[n] & kReceived) != 0 ? 0x10 : 0);
  }
  return s;
}

void UsbController::update_irq() {
  around_.set_irq(irq_, (status() & control_ & 0xFF80) != 0);
}

std::uint32_t UsbController::read(std::uint32_t offset, unsigned) {
  if (offset < 4 * kEndpoints) return endpoints_[offset / 4];
  switch (offset) {
    case 0x40:
      return control_;
    case 0x44:
      return status();
    case 0x4C:
      return address_;
    case 0x50:
      return table_;
    case 0x58:
      return pull_up_ ? 1U << 15 : 0;
    default:
      return 0;
  }
}

void UsbController::write(std::uint32_t offset, std::uint32_t value, unsigned size) {
  if (size == 1) around_.violation("USB register written in bytes");
  if (offset < 4 * kEndpoints) {
    write_endpoint(offset / 4, value);
  } else {
    switch (offset) {
      case 0x40:
        write_control(value & 0xFFFF);
        break;
      case 0x44:
        events_ &= value;
        break;
      case 0x4C:
        address_ = value & 0xFF;
        break;
      case 0x50:
        table_ = value & 0xFFF8;
        break;
      case 0x58:
        pull_up_ = (value >> 15 & 1) != 0;
        break;
      default:
        around_.violation(fmt::format("USB register {:#x} is not modelled", offset));
    }
  }
  update_irq();
}

// The block is powered up first and leaves reset 1 µs later (§45.5.2); a bus reset while it runs resets the end
// points.
void UsbController::write_control(std::uint32_t value) {
  if ((control_ & 2) != 0 && (value & 2) == 0) {
    powered_ = around_.time().now();
    if (!clock_ready_()) around_.violation("USB powered without its 48 MHz");
    if (!supplied_()) around_.violation("USB powered while PWR_CR2.USV cuts its supply off");
  }
  if ((control_ & 1) != 0 && (value & 1) == 0 && (powered_ == kNever || around_.time().now() < powered_ + kStartUp)) {
    around_.violation("USB taken out of reset before its transceiver has started");
  }
  control_ = value;
  if ((value & 1) == 0) return;
  endpoints_ = {};
  address_ = 0;
}

void UsbController::write_endpoint(std::size_t n, std::uint32_t value) {
  if ((control_ & 3) != 0) around_.violation("USB end point set up while the block is in reset");
  std::uint32_t& r = endpoints_[n];
  const std::uint32_t flags = r & value & (kReceived | kSent);
  r = flags | (r & kSetup) | (value & kPlain) | ((r ^ value) & kToggled);
}

bool UsbController::memory_access(std::uint32_t offset, unsigned size) {
  if (size == 2 && offset + 2 <= kMemoryBytes) return true;
  around_.violation(fmt::format("USB packet memory: {} bytes at {:#x}; it takes half-words inside 1 KB", size, offset));
  return false;
}

std::uint32_t UsbController::read_memory(std::uint32_t offset, unsigned size) {
  return memory_access(offset, size) ? memory_[offset] | static_cast<std::uint32_t>(memory_[offset + 1]) << 8 : 0;
}

void UsbController::write_memory(std::uint32_t offset, std::uint32_t value, unsigned size) {
  if (!memory_access(offset, size)) return;
  memory_[offset] = static_cast<std::uint8_t>(value);
  memory_[offset + 1] = static_cast<std::uint8_t>(value >> 8);
}

std::uint32_t UsbController::descriptor(std::size_t n, std::uint32_t field) const {
  const std::size_t at = (table_ + 8 * n + 2 * field) % kMemoryBytes;
  return memory_[at] | static_cast<std::uint32_t>(memory_[at + 1]) << 8;
}

void UsbController::set_descriptor(std::size_t n, std::uint32_t field, std::uint32_t value) {
  const std::size_t at = (table_ + 8 * n + 2 * field) % kMemoryBytes;
  memory_[at] = static_cast<std::uint8_t>(value);
  memory_[at + 1] = static_cast<std::uint8_t>(value >> 8);
}

// The block size is 2 or 32 bytes (§45.6.3). A packet that is too long is a violation: the hardware would stop
// writing.
bool UsbController::store(std::size_t n, std::span<const std::uint8_t> bytes) {
  const std::uint32_t at = descriptor(n, kReceiveAddress), count = descriptor(n, kReceiveCount);
  const std::uint32_t room = (count >> 15 & 1) != 0 ? 32 * ((count >> 10 & 31) + 1) : 2 * (count >> 10 & 31);
  if (bytes.size() > room || at + bytes.size() > kMemoryBytes) {
    around_.violation(fmt::format("USB end point {}: {} bytes for a buffer of {}", n, bytes.size(), room));
    return false;
  }
  std::ranges::copy(bytes, memory_.begin() + at);
  set_descriptor(n, kReceiveCount, (count & 0xFC00) | static_cast<std::uint32_t>(bytes.size()));
  return true;
}

std::uint32_t* UsbController::find(std::uint8_t address, std::uint8_t endpoint) {
  if (!attached() || (address_ & 0x80) == 0 || (address_ & 0x7F) != address) return nullptr;
  const auto r = std::ranges::find_if(endpoints_, [&](std::uint32_t e) {
    return (e & 0xF) == endpoint && (receive_status(e) != kDisabled || send_status(e) != kDisabled);
  });
  return r == endpoints_.end() ? nullptr : &*r;
}

void UsbController::bus_reset() {
  endpoints_ = {};
  address_ = 0;
  events_ |= kReset;
  update_irq();
}

void UsbController::bus_suspend(bool suspended) {
  events_ |= suspended ? kSuspend : kWakeUp;
  update_irq();
}

// A control end point takes a SETUP even while it answers NAK or STALL, but not while another one is unserved
// (§45.5.3).
UsbReply UsbController::setup(std::uint8_t address, std::span<const std::uint8_t, 8> bytes) {
  std::uint32_t* r = find(address, 0);
  if (r == nullptr || !control_type(*r) || receive_status(*r) == kDisabled || (*r & kReceived) != 0)
    return UsbReply::kNone;
  if (!store(index_of(r), bytes)) return UsbReply::kNone;
  *r |= kReceived | kSetup | kReceiveToggle | kSendToggle;  // The next packet of either direction is DATA1.
  set_receive_status(*r, kNak);
  set_send_status(*r, kNak);
  update_irq();
  return UsbReply::kAck;
}

UsbReply UsbController::out(std::uint8_t address, std::uint8_t endpoint, bool data1,
                            std::span<const std::uint8_t> bytes) {
  std::uint32_t* r = find(address, endpoint);
  if (r == nullptr || receive_status(*r) == kDisabled) return UsbReply::kNone;
  if (receive_status(*r) == kStall) return UsbReply::kStall;
  if (receive_status(*r) == kNak) return UsbReply::kNak;
  if (data1 != ((*r & kReceiveToggle) != 0))
    return UsbReply::kAck;  // The packet was received before, but the host missed the acknowledgement.
  if (!store(index_of(r), bytes)) return UsbReply::kNone;
  *r = (*r & ~kSetup) | kReceived;
  *r ^= kReceiveToggle;
  set_receive_status(*r, kNak);
  update_irq();
  return UsbReply::kAck;
}

UsbIn UsbController::in(std::uint8_t address, std::uint8_t endpoint) {
  std::uint32_t* r = find(address, endpoint);
  if (r == nullptr || send_status(*r) == kDisabled) return {};
  if (send_status(*r) != kValid) return {send_status(*r) == kStall ? UsbReply::kStall : UsbReply::kNak, false, {}};
  const std::size_t n = index_of(r);
  const std::uint32_t at = descriptor(n, kSendAddress), count = descriptor(n, kSendCount) & 0x3FF;
  if (at + count > kMemoryBytes) {
    around_.violation(fmt::format("USB end point {}: sends from outside the packet memory", n));
    return {};
  }
  UsbIn in{UsbReply::kAck, (*r & kSendToggle) != 0, {memory_.begin() + at, memory_.begin() + at + count}};
  *r |= kSent;
  *r ^= kSendToggle;
  set_send_status(*r, kNak);
  update_irq();
  return in;
}

}  // namespace triskin::machine

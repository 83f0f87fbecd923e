// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/machine/bxcan.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "triskin/machine/map_l452.hpp"

namespace triskin::machine {
namespace {

// Offsets of registers.
constexpr std::uint32_t kMcr = 0x00, kMsr = 0x04, kTsr = 0x08, kRf0r = 0x0C, kRf1r = 0x10, kIer = 0x14, kEsr = 0x18,
                        kBtr = 0x1C, kMailboxes = 0x180, kFifo0 = 0x1B0, kFifo0End = 0x1C0, kFmr = 0x200, kFm1r = 0x204,
                        kFs1r = 0x20C, kFfa1r = 0x214, kFa1r = 0x21C, kBanksAt = 0x240;
constexpr std::uint32_t kInrq = 1, kSleep = 2, kInOrder = 4, kResetControl = 0x00010002;
constexpr std::uint32_t kTransmit = 1, kRemote = 2, kExtended = 4;
constexpr std::uint32_t kTmeie = 1, kFmpie0 = 2, kFfie0 = 4, kFovie0 = 8, kEwgie = 1U << 8, kEpvie = 1U << 9,
                        kBofie = 1U << 10, kErrie = 1U << 15;

std::uint32_t identifier_of(const wire::CanFrame& f) {
  return f.extended ? f.id << 3 | kExtended : f.id << 21;
}

wire::CanFrame frame_of(const std::array<std::uint32_t, 4>& e) {
  wire::CanFrame f;
  f.extended = (e[0] & kExtended) != 0;
  f.id = f.extended ? e[0] >> 3 : e[0] >> 21;
  f.size = static_cast<std::uint8_t>(std::min(e[1] & 15U, 8U));
  for (std::size_t k = 0; k < f.size; ++k) f.data[k] = static_cast<std::uint8_t>(e[2 + k / 4] >> (8 * (k % 4)));
  return f;
}

}  // namespace

// The block sleeps after a reset; a master reset finds the filters in their initialization.
void Bxcan::reset() {
  reset_bus();
  mode_ = Mode::kSleep;
  control_ = kResetControl;
  interrupts_ = 0;
  timing_ = 0x01230000;
  error_interrupt_ = overrun_ = false;
  mailboxes_ = {};
  pending_ = completed_ = {};
  requests_.clear();
  fifo_.clear();
  filter_init_ = 1;
  filter_mode_ = filter_scale_ = filter_fifo_ = filter_active_ = 0;
  banks_ = {};
  update_irqs();
}

Time Bxcan::bit_time(bool) const {
  const Time quantum = ((timing_ & 1023) + 1) * (kSecond / around_.sysclk_hz());
  return quantum * (1 + (timing_ >> 16 & 15) + 1 + (timing_ >> 20 & 7) + 1);
}

void Bxcan::update_irqs() {
  const bool done = std::ranges::any_of(completed_, [](bool c) { return c; });
  around_.set_irq(map::l452::kCanSendIrq, (interrupts_ & kTmeie) != 0 && done);
  const bool waits = (interrupts_ & kFmpie0) != 0 && !fifo_.empty();
  const bool full = (interrupts_ & kFfie0) != 0 && fifo_.size() == kDepth;
  around_.set_irq(map::l452::kCanReceiveIrq, waits || full || ((interrupts_ & kFovie0) != 0 && overrun_));
  around_.set_irq(map::l452::kCanStateIrq, (interrupts_ & kErrie) != 0 && error_interrupt_);
}

void Bxcan::note_state(const State& before) {
  const State now = state();
  const bool warning = now.warning && !before.warning && (interrupts_ & kEwgie) != 0;
  const bool passive = now.passive && !before.passive && (interrupts_ & kEpvie) != 0;
  const bool off = now.off && !before.off && (interrupts_ & kBofie) != 0;
  if (warning || passive || off) error_interrupt_ = true;
}

// The next one to send, by TXFP: the oldest request, or the lowest identifier.
std::size_t Bxcan::next_mailbox() const {
  if ((control_ & kInOrder) != 0) return requests_.front();
  return *std::ranges::min_element(requests_, {}, [this](std::size_t k) { return mailboxes_[k][0]; });
}

std::optional<wire::CanFrame> Bxcan::next_to_send() const {
  if (requests_.empty()) return std::nullopt;
  return frame_of(mailboxes_[next_mailbox()]);
}

void Bxcan::note_sent() {
  const std::size_t k = next_mailbox();
  std::erase(requests_, k);
  pending_[k] = false;
  completed_[k] = true;
  mailboxes_[k][0] &= ~kTransmit;
}

// A bank of 32 bits compares identifier, kind and remote bit where its mask has ones.
bool Bxcan::accepted(std::uint32_t identifier) const {
  for (std::size_t k = 0; k < kBanks; ++k) {
    if ((filter_active_ >> k & 1) != 0 && ((identifier ^ banks_[k][0]) & banks_[k][1]) == 0) return true;
  }
  return false;
}

void Bxcan::deliver(const wire::CanFrame& frame) {
  if (!running()) return;
  if (frame.fd) return around_.violation("bxCAN: an FD frame on the bus, which a classic node destroys");
  const std::uint32_t identifier = identifier_of(frame);
  if (!accepted(identifier)) return;
  Element e{identifier, frame.size, 0, 0};
  for (std::size_t k = 0; k < frame.size; ++k)
    e[2 + k / 4] |= static_cast<std::uint32_t>(frame.data[k]) << (8 * (k % 4));
  // Without a lock the newest frame of a full FIFO is overwritten.
  overrun_ = overrun_ || fifo_.size() == kDepth;
  if (fifo_.size() == kDepth)
    fifo_.back() = e;
  else
    fifo_.push_back(e);
  update_irqs();
}

std::uint32_t Bxcan::transmit_status() const {
  std::uint32_t v = 0;
  for (std::size_t k = kDepth; k-- > 0;) {
    if (completed_[k]) v |= 3U << (8 * k);  // Completed and without an error.
    if (pending_[k]) continue;
    v = (v & ~(3U << 24)) | 1U << (26 + k) | static_cast<std::uint32_t>(k) << 24;
  }
  return v;
}

std::uint32_t Bxcan::error_status() const {
  const State s = state();
  return (s.warning ? 1U : 0U) | (s.passive ? 2U : 0U) | (s.off || recovers() ? 4U : 0U) |
         std::min(send_errors(), 255U) << 16 | std::min(receive_errors(), 255U) << 24;
}

std::uint32_t Bxcan::read(std::uint32_t offset, unsigned) {
  if (offset >= kMailboxes && offset < kFifo0)
    return mailboxes_[(offset - kMailboxes) / 16][(offset - kMailboxes) % 16 / 4];
  if (offset >= kFifo0 && offset < kFifo0End) {
    if (!fifo_.empty()) return fifo_.front()[(offset - kFifo0) / 4];
    around_.violation("bxCAN: FIFO 0 read while empty");
    return 0;
  }
  if (offset >= kBanksAt && offset < kBanksAt + 8 * kBanks)
    return banks_[(offset - kBanksAt) / 8][(offset - kBanksAt) % 8 / 4];
  switch (offset) {
    case kMcr:
      return control_;
    case kMsr:
      return (mode_ == Mode::kInitialization ? 1U : 0U) | (mode_ == Mode::kSleep ? 2U : 0U) |
             (error_interrupt_ ? 4U : 0U) | 0xC00U;
    case kTsr:
      return transmit_status();
    case kRf0r:
      return static_cast<std::uint32_t>(fifo_.size()) | (fifo_.size() == kDepth ? 8U : 0U) | (overrun_ ? 16U : 0U);
    case kRf1r:
      return 0;
    case kIer:
      return interrupts_;
    case kEsr:
      return error_status();
    case kBtr:
      return timing_;
    case kFmr:
      return 0x2A1C0E00U | filter_init_;
    case kFm1r:
      return filter_mode_;
    case kFs1r:
      return filter_scale_;
    case kFfa1r:
      return filter_fifo_;
    case kFa1r:
      return filter_active_;
    default:
      around_.violation(fmt::format("bxCAN register {:#x} is not modelled", offset));
      return 0;
  }
}

// Initialization begins when the frame under way has ended; normal mode begins after eleven recessive bits.
void Bxcan::enter_initialization() {
  if (bus_busy() && mode_ == Mode::kNormal) {
    after(bit_time(false), [this] { enter_initialization(); });
    return;
  }
  if ((control_ & kInrq) == 0) return;
  mode_ = Mode::kInitialization;
}

void Bxcan::leave_initialization() {
  if (!pins_ready_()) around_.violation("bxCAN started while a pin is not its alternate function");
  if (bit_time(false) != kMicrosecond)
    around_.violation(fmt::format("bxCAN: a bit takes {} ps, on a bus of 1 Mbit/s", bit_time(false)));
  after(bit_time(false) * 11, [this] {
    if ((control_ & (kInrq | kSleep)) != 0) return;
    mode_ = Mode::kNormal;
    if (bus_off()) rejoin();
    next_on_bus();
  });
}

void Bxcan::write_mode(std::uint32_t value) {
  const std::uint32_t before = control_;
  if ((value & 1U << 15) != 0) return reset();
  control_ = value;
  if ((value & kSleep) != 0) return;
  if ((value & kInrq) != 0 && mode_ != Mode::kInitialization) enter_initialization();
  if ((value & kInrq) == 0 && (before & (kInrq | kSleep)) != 0) leave_initialization();
}

void Bxcan::write_mailbox(std::uint32_t offset, std::uint32_t value) {
  const std::size_t k = offset / 16;
  if (pending_[k]) return around_.violation("bxCAN: mailbox written while its transmission is pending");
  mailboxes_[k][offset % 16 / 4] = value;
  if (offset % 16 != 0 || (value & kTransmit) == 0) return;
  if ((value & kRemote) != 0) around_.violation("bxCAN: remote frames are not modelled");
  pending_[k] = true;
  completed_[k] = false;
  requests_.push_back(k);
}

void Bxcan::write_filter(std::uint32_t offset, std::uint32_t value) {
  if (offset == kFmr) {
    filter_init_ = value & 1;
    if (filter_init_ == 0 && (filter_active_ & (filter_mode_ | ~filter_scale_ | filter_fifo_)) != 0)
      around_.violation("bxCAN: only filters of 32 bits with a mask, into FIFO 0, are modelled");
    return;
  }
  if (offset >= kBanksAt) {
    const std::size_t bank = (offset - kBanksAt) / 8;
    if (filter_init_ == 0 && (filter_active_ >> bank & 1) != 0)
      return around_.violation(fmt::format("bxCAN: filter {} written while it is active", bank));
    banks_[bank][(offset - kBanksAt) % 8 / 4] = value;
    return;
  }
  if (filter_init_ == 0 && offset != kFa1r)
    return around_.violation(fmt::format("bxCAN: register {:#x} written without FINIT", offset));
  (offset == kFm1r    ? filter_mode_
   : offset == kFs1r  ? filter_scale_
   : offset == kFfa1r ? filter_fifo_
                      : filter_active_) = value & ((1U << kBanks) - 1);
}

void Bxcan::clear_requests(std::uint32_t value) {
  constexpr std::uint32_t kAborts = 1U << 7 | 1U << 15 | 1U << 23;
  if ((value & kAborts) != 0) around_.violation("bxCAN: aborting a transmission is not modelled");
  for (std::size_t k = 0; k < kDepth; ++k) {
    if ((value >> (8 * k) & 1) != 0) completed_[k] = false;
  }
}

void Bxcan::write(std::uint32_t offset, std::uint32_t value, unsigned) {
  const bool filter = offset == kFmr || offset == kFm1r || offset == kFs1r || offset == kFfa1r || offset == kFa1r ||
                      (offset >= kBanksAt && offset < kBanksAt + 8 * kBanks);
  if (offset >= kMailboxes && offset < kFifo0) {
    write_mailbox(offset - kMailboxes, value);
  } else if (filter) {
    write_filter(offset, value);
  } else if (offset == kMcr) {
    write_mode(value);
  } else if (offset == kMsr) {
    error_interrupt_ = error_interrupt_ && (value & 4) == 0;
  } else if (offset == kTsr) {
    clear_requests(value);
  } else if (offset == kRf0r) {
    if ((value & 16) != 0) overrun_ = false;
    if ((value & 32) != 0 && fifo_.empty()) around_.violation("bxCAN: FIFO 0 released while empty");
    if ((value & 32) != 0 && !fifo_.empty()) fifo_.pop_front();
  } else if (offset == kIer) {
    interrupts_ = value;
  } else if (offset == kBtr) {
    if (mode_ != Mode::kInitialization) around_.violation("bxCAN: BTR written outside initialization");
    if ((value >> 30) != 0) around_.violation("bxCAN: loop-back and silent mode are not modelled");
    timing_ = value;
  } else {
    around_.violation(fmt::format("bxCAN register {:#x} is not modelled, or read-only", offset));
  }
  update_irqs();
  next_on_bus();
}

}  // namespace triskin::machine

// SPDX-License-Identifier: Apache-2.0
#include "can.hpp"

#include <algorithm>

#include "interrupt_timer.hpp"
#include "triskin/board/board.hpp"
#include "triskin/board/board_config.hpp"
#include "triskin/board/budget.hpp"
#include "triskin/board/clock_plan.hpp"
#include "triskin/board/priorities.hpp"
#include "triskin/board/registers/fdcan.hpp"
#include "triskin/board/registers/system.hpp"

namespace triskin::board {

using namespace fdcan_reg;

Stm32CanPort can;

namespace {

template <std::size_t N>
struct Queue {
  std::array<wire::CanFrame, N> frames;
  volatile std::size_t head = 0, tail = 0;
  [[nodiscard]] bool full() const { return (head + 1) % N == tail; }
};
// The queue is not a member of the port: with its table of functions the port has initial values, which are stored in
// the flash.
constinit Queue<32> received;
constinit Queue<16> waiting;

constexpr std::array<std::uint8_t, 16> kSizes{0, 1, 2, 3, 4, 5, 6, 7, 8, 12, 16, 20, 24, 32, 48, 64};
// Both phases have the same time quantum, as CiA's "Generic bit-timing settings for CAN FD" recommends, so that a node
// loses no part of a quantum when the rate switches. 160 MHz / 2 gives 80 quanta of 12.5 ns in a nominal bit and 40 in
// one of the data phase; four fifths of them are before the sample point.
constexpr std::uint32_t kPrescaler = 2;
struct BitTiming {
  // `before` excludes the first quantum and ends at the sample point; `after` follows it.
  std::uint32_t bit_hz, prescaler, before, after;
  [[nodiscard]] constexpr std::uint32_t quanta() const { return 1 + before + after; }
};
constexpr BitTiming kNominal{1'000'000, kPrescaler, 63, 16}, kData{2'000'000, kPrescaler, 31, 8};
static_assert(kNominal.prescaler == kData.prescaler);
static_assert(kNominal.quanta() * kNominal.prescaler * kNominal.bit_hz == kSysclk_hz);
static_assert(kData.quanta() * kData.prescaler * kData.bit_hz == kSysclk_hz);
static_assert((1 + kNominal.before) * kData.quanta() ==
              (1 + kData.before) * kNominal.quanta());  // Both have the same sample point.
// The loop delay of the transceiver is measured in each frame. The second sample point follows it at the same distance
// as the sample point within a bit, in clocks of the block. M_CAN allows this only with a data prescaler of 1 or 2.
static_assert(kData.prescaler <= 2);
constexpr std::uint32_t kDelayOffset = (1 + kData.before) * kData.prescaler << kDelayOffsetShift;

constexpr std::uint32_t kNominalTiming = (kNominal.after - 1) << kNominalJumpShift |
                                         (kNominal.prescaler - 1) << kNominalPrescalerShift |
                                         (kNominal.before - 1) << kNominalBeforeShift | (kNominal.after - 1);
constexpr std::uint32_t kDataTiming = kDelayCompensation | (kData.prescaler - 1) << kDataPrescalerShift |
                                      (kData.before - 1) << kDataBeforeShift | (kData.after - 1) << kDataAfterShift |
                                      (kData.after - 1);

std::uint32_t word(std::uint32_t offset) {
  return Register(kRam + offset).read();
}
void word(std::uint32_t offset, std::uint32_t value) {
  Register(kRam + offset).write(value);
}

std::uint32_t code_of(std::uint8_t size) {
  std::uint32_t code = 0;
  while (kSizes[code] < size) ++code;
  return code;
}

wire::CanFrame read_element(std::uint32_t offset) {
  const std::uint32_t w0 = word(offset), w1 = word(offset + 4);
  wire::CanFrame f;
  f.extended = (w0 & kExtendedId) != 0;
  f.id = f.extended ? w0 & 0x1FFFFFFFU : w0 >> kStandardIdShift & 0x7FFU;
  f.fd = (w1 & kFdFrame) != 0;
  f.bit_rate_switch = (w1 & kRateSwitched) != 0;
  f.size = kSizes[w1 >> kSizeShift & 0xF];
  if (!f.fd && f.size > 8) f.size = 8;
  for (std::uint32_t k = 0; k < f.size; k += 4) {
    const std::uint32_t w = word(offset + 8 + k);
    for (std::uint32_t b = 0; b < 4 && k + b < f.size; ++b) f.data[k + b] = static_cast<std::uint8_t>(w >> (8 * b));
  }
  return f;
}

void write_element(std::uint32_t offset, const wire::CanFrame& f) {
  word(offset, f.extended ? kExtendedId | f.id : f.id << kStandardIdShift);
  const std::uint32_t code = code_of(f.size);
  word(offset + 4, code << kSizeShift | (f.fd ? kFdFrame : 0) | (f.bit_rate_switch ? kRateSwitched : 0));
  for (std::uint32_t k = 0; k < kSizes[code]; k += 4) {
    std::uint32_t w = 0;
    for (std::uint32_t b = 0; b < 4; ++b) w |= static_cast<std::uint32_t>(f.data[k + b]) << (8 * b);
    word(offset + 8 + k, w);
  }
}

// A patch receives these frames: diagnostics in 29 bits (physical and functional), discovery, assignment and leases,
// updates, polling class 2 and management class 7 in 11 bits.
void write_filters(CanFilters filters) {
  constexpr std::uint32_t kRefuseOther = 2;
  word(kStandardFilters, kMaskFilter | kStandardToFifo0 | 0x200U << kFilterIdShift | 0x700U);
  word(kStandardFilters + 4, kMaskFilter | kStandardToFifo0 | 0x700U << kFilterIdShift | 0x700U);
  word(kExtendedFilters, kExtendedToFifo0 | 0x18DA0000U);
  word(kExtendedFilters + 4, kMaskFilter | 0x1FFE0000U);
  // Both the loader and the application use these identifiers for updates.
  word(kExtendedFilters + 8, kExtendedToFifo0 | 0x1BF00000U);
  word(kExtendedFilters + 12, kMaskFilter | 0x1FF00000U);
  word(kExtendedFilters + 16, kExtendedToFifo0 | 0x18E00000U);  // The filter covers 18E0 … 18E3.
  word(kExtendedFilters + 20, kMaskFilter | 0x1FFC0000U);
  const std::uint32_t extended = filters == CanFilters::kApplication ? 3 : 2;
  kRxgfc.write(extended << kExtendedCountShift | 2U << kStandardCountShift | kRefuseOther << kOtherStandardShift |
               kRefuseOther << kOtherExtendedShift | kRefuseRemote);
}

// Off the bus no transmission may be requested, so frames wait.
void fill_transmit_buffers() {
  if (kCccr.any(kInit)) return;
  while (waiting.head != waiting.tail) {
    const std::uint32_t state = kTxfqs.read();
    if ((state & kTxFull) != 0) return;
    const std::uint32_t index = state >> kTxPutShift & kFifoIndexMask;
    write_element(kTxBuffers + index * kElementBytes, waiting.frames[waiting.tail]);
    waiting.tail = (waiting.tail + 1) % waiting.frames.size();
    kTxbar.write(bit(index));
  }
}

}  // namespace

void Stm32CanPort::open(CanFilters filters) {
  rcc_reg::kCcipr.set(rcc_reg::kFdcanFromPclk1);
  rcc_reg::kApb1Enr1.set(rcc_reg::kFdcan);
  (void)rcc_reg::kApb1Enr1.read();
  for (const Pin pin : {pins::kCanReceive, pins::kCanSend}) {
    open_port(pin);
    Gpio(pin).very_high_speed();
    Gpio(pin).alternate(pins::kFunctionCan);
    Gpio(pin).mode(PinMode::kAlternate);
  }
  kCccr.set(kInit);
  while (!kCccr.any(kInit)) {
  }
  kCccr.set(kConfigure);
  kCccr.set(kFdOperation | kBitRateSwitch);
  kNbtp.write(kNominalTiming);
  kDbtp.write(kDataTiming);
  kTdcr.write(kDelayOffset);
  for (std::uint32_t k = 0; k < kRamBytes; k += 4) word(k, 0);
  write_filters(filters);
  kTxbc.write(0);  // In FIFO mode, frames are sent in the order in which they came.
  kTxbtie.write(7);
  kIe.write(kRxNew | kRxLost | kTxDone | kRamFailed | kBusOff);
  kIle.write(1);
  kCccr.clear(kInit);
  while (kCccr.any(kInit)) {
  }
  core_reg::set_priority(kIrq0, priority::kCan);
  core_reg::enable_interrupt(kIrq0);
}

bool Stm32CanPort::send(const wire::CanFrame& frame) {
  const InterruptLock lock;
  if (waiting.full()) return false;
  waiting.frames[waiting.head] = frame;
  waiting.head = (waiting.head + 1) % waiting.frames.size();
  fill_transmit_buffers();
  return true;
}

bool Stm32CanPort::has_room() const {
  return !waiting.full();
}

bool Stm32CanPort::frame_waits() const {
  return received.head != received.tail;
}

std::optional<wire::CanFrame> Stm32CanPort::receive() {
  const InterruptLock lock;
  if (received.head == received.tail) return std::nullopt;
  const wire::CanFrame frame = received.frames[received.tail];
  received.tail = (received.tail + 1) % received.frames.size();
  return frame;
}

void Stm32CanPort::note_bus_off() {
  constexpr std::uint64_t kFirstPause_us = 10'000, kMaxPause_us = 1'000'000, kCalm_us = 5'000'000;
  const std::uint64_t now_us = microseconds();
  bus_offs_ = bus_offs_ + 1;
  const bool calm = pause_us_ == 0 || now_us > joined_at_us_ + kCalm_us;
  pause_us_ = calm ? kFirstPause_us : std::min(2 * pause_us_, kMaxPause_us);
  rejoin_at_us_ = now_us + pause_us_;
}

// The block sends again after it has seen eleven recessive bits 129 times (§44.3.3).
void Stm32CanPort::step(std::uint64_t now_us) {
  const InterruptLock lock;
  if (now_us < rejoin_at_us_) return;
  rejoin_at_us_ = UINT64_MAX;
  joined_at_us_ = now_us;
  kCccr.clear(kInit);
  while (kCccr.any(kInit)) {  // The block needs some of its own clocks to follow.
  }
  fill_transmit_buffers();
}

void Stm32CanPort::describe(wire::BoardHealth& h) const {
  const std::uint32_t counters = kEcr.read(), status = kPsr.read();
  h.can_send_errors = static_cast<std::uint8_t>(counters & kSendErrorsMask);
  h.can_receive_errors = static_cast<std::uint8_t>(counters >> kReceiveErrorsShift & kReceiveErrorsMask);
  h.can_last_error = static_cast<std::uint8_t>(status & kLastErrorMask);
  h.can_state = static_cast<std::uint8_t>(((status & kPsrWarning) != 0 ? wire::can_state::kWarning : 0) |
                                          ((status & kPsrPassive) != 0 ? wire::can_state::kErrorPassive : 0) |
                                          ((status & kPsrBusOff) != 0 ? wire::can_state::kBusOff : 0));
  h.bus_offs = bus_offs_;
  h.can_ram_failures = ram_failures_;
  h.can_lost = triskin_budget.can_lost;
}

void Stm32CanPort::on_interrupt() {
  const std::uint32_t flags = kIr.read();
  kIr.write(flags);
  if ((flags & kRxLost) != 0) ++triskin_budget.can_lost;
  if ((flags & kRamFailed) != 0) {
    ram_failures_ = static_cast<std::uint16_t>(ram_failures_ + 1);
    // The block sets this bit itself, and would then neither acknowledge nor send for ever (§44.3.3).
    kCccr.clear(kRestricted);
  }
  if ((flags & kBusOff) != 0 && kPsr.any(kPsrBusOff)) note_bus_off();
  for (std::uint32_t state = kRxf0s.read(); (state & kFifoLevelMask) != 0; state = kRxf0s.read()) {
    const std::uint32_t index = state >> kFifoGetShift & kFifoIndexMask;
    if (received.full()) {
      ++triskin_budget.can_lost;
    } else {
      received.frames[received.head] = read_element(kRxFifo0 + index * kElementBytes);
      received.head = (received.head + 1) % received.frames.size();
    }
    kRxf0a.write(index);
  }
  fill_transmit_buffers();
}

}  // namespace triskin::board

extern "C" void fdcan_handler() {
  const triskin::board::InterruptTimer timer;
  triskin::board::can.on_interrupt();
}

// SPDX-License-Identifier: Apache-2.0
#include "can.hpp"

#include "triskin/board/board_config.hpp"
#include "triskin/board/clock_plan.hpp"
#include "triskin/board/priorities.hpp"
#include "triskin/board/registers/fdcan.hpp"
#include "triskin/board/registers/system.hpp"

namespace triskin::board {

using namespace fdcan_reg;

namespace {

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

void read_element(std::uint32_t offset, wire::CanFrame& f) {
  const std::uint32_t w0 = word(offset), w1 = word(offset + 4);
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

}  // namespace

bool can_block::fd() {
  return true;
}

void can_block::open(CanFilters filters) {
  rcc_reg::kCcipr.set(rcc_reg::kFdcanFromPclk1);
  rcc_reg::kApb1Enr1.set(rcc_reg::kCan);
  (void)rcc_reg::kApb1Enr1.read();
  open_can_pins();
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
  core_reg::set_priority(can_irq::kFirst, priority::kCan);
  core_reg::enable_interrupt(can_irq::kFirst);
}

// Off the bus no transmission may be requested.
bool can_block::transmit(const wire::CanFrame& frame) {
  if (kCccr.any(kInit)) return false;
  const std::uint32_t state = kTxfqs.read();
  if ((state & kTxFull) != 0) return false;
  const std::uint32_t index = state >> kTxPutShift & kFifoIndexMask;
  write_element(kTxBuffers + index * kElementBytes, frame);
  kTxbar.write(bit(index));
  return true;
}

// The block sends again after it has seen eleven recessive bits 129 times (§44.3.3).
void can_block::rejoin() {
  kCccr.clear(kInit);
  while (kCccr.any(kInit)) {  // The block needs some of its own clocks to follow.
  }
}

void can_block::describe(wire::BoardHealth& h) {
  const std::uint32_t counters = kEcr.read(), status = kPsr.read();
  h.can_send_errors = static_cast<std::uint8_t>(counters & kSendErrorsMask);
  h.can_receive_errors = static_cast<std::uint8_t>(counters >> kReceiveErrorsShift & kReceiveErrorsMask);
  h.can_last_error = static_cast<std::uint8_t>(status & kLastErrorMask);
  h.can_state = static_cast<std::uint8_t>(((status & kPsrWarning) != 0 ? wire::can_state::kWarning : 0) |
                                          ((status & kPsrPassive) != 0 ? wire::can_state::kErrorPassive : 0) |
                                          ((status & kPsrBusOff) != 0 ? wire::can_state::kBusOff : 0));
}

can_block::Events can_block::take_events() {
  const std::uint32_t flags = kIr.read();
  kIr.write(flags);
  // The block sets this bit itself when its message RAM fails, and would then never send again (§44.3.3).
  if ((flags & kRamFailed) != 0) kCccr.clear(kRestricted);
  return {(flags & kRxLost) != 0, (flags & kRamFailed) != 0, (flags & kBusOff) != 0 && kPsr.any(kPsrBusOff)};
}

bool can_block::take_frame(wire::CanFrame& frame) {
  const std::uint32_t state = kRxf0s.read();
  if ((state & kFifoLevelMask) == 0) return false;
  const std::uint32_t index = state >> kFifoGetShift & kFifoIndexMask;
  read_element(kRxFifo0 + index * kElementBytes, frame);
  kRxf0a.write(index);
  return true;
}

}  // namespace triskin::board

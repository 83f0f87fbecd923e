// SPDX-License-Identifier: Apache-2.0
#include "can.hpp"

#include <algorithm>

#include "triskin/board/board_config.hpp"
#include "triskin/board/clock_plan.hpp"
#include "triskin/board/priorities.hpp"
#include "triskin/board/registers/bxcan.hpp"
#include "triskin/board/registers/system.hpp"

namespace triskin::board {

using namespace bxcan_reg;

namespace {

// Twenty time quanta of 50 ns are a bit; four fifths of them are before the sample point, as on the other boards.
constexpr std::uint32_t kBit_hz = 1'000'000, kPrescaler = 4, kBefore = 15, kAfter = 4, kJump = 4;
static_assert((1 + kBefore + kAfter) * kPrescaler * kBit_hz == kSysclk_hz);
constexpr std::uint32_t kTiming =
    (kJump - 1) << kJumpShift | (kAfter - 1) << kAfterShift | (kBefore - 1) << kBeforeShift | (kPrescaler - 1);
// The block follows a request within some of its bits while nobody disturbs the bus.
constexpr std::uint32_t kLooks = 100'000;

std::uint32_t identifier_word(bool extended, std::uint32_t id) {
  return extended ? id << kExtendedShift | kExtended : id << kStandardShift;
}

struct Filter {
  bool extended;
  std::uint32_t id, mask;
};
// A patch receives these frames: polling class 2 and management class 7 in 11 bits; diagnostics in 29 bits (physical
// and functional), updates, and 18E0 … 18E3 with discovery, assignment and leases.
constexpr Filter kFilters[]{{false, 0x200, 0x700},
                            {false, 0x700, 0x700},
                            {true, 0x18DA0000, 0x1FFE0000},
                            {true, 0x1BF00000, 0x1FF00000},
                            {true, 0x18E00000, 0x1FFC0000}};

// A filter decides about the kind of a frame as well, and lets no remote frame pass.
void write_filters(std::size_t count) {
  kFmr.set(kFilterInit);
  const std::uint32_t used = (1U << count) - 1;
  kFa1r.write(0);
  kFm1r.write(0);     // Each bank has an identifier and a mask …
  kFs1r.write(used);  // … of 32 bits …
  kFfa1r.write(0);    // … and stores into FIFO 0.
  for (std::uint32_t k = 0; k < count; ++k) {
    const Filter& f = kFilters[k];
    const std::uint32_t bank = kFilterBanks + kFilterBytes * k;
    Register(bank).write(identifier_word(f.extended, f.id));
    Register(bank + kFilterMask).write(identifier_word(f.extended, f.mask) | kExtended | kRemote);
  }
  kFa1r.write(used);
  kFmr.clear(kFilterInit);
}

void wait_for_init() {
  for (std::uint32_t k = 0; k < kLooks && !kMsr.any(kInitAcknowledge); ++k) {
  }
}

}  // namespace

bool can_block::fd() {
  return false;
}

// Nobody waits until the block has left initialization: it needs eleven recessive bits, which a broken bus may not
// have. A transmission that is requested meanwhile waits in its mailbox.
void can_block::open(CanFilters filters) {
  rcc_reg::kApb1Enr1.set(rcc_reg::kCan);
  (void)rcc_reg::kApb1Enr1.read();
  open_can_pins();
  kMcr.modify(kSleep, kInitRequest);
  wait_for_init();
  kBtr.write(kTiming);
  write_filters(filters == CanFilters::kApplication ? std::size(kFilters) : std::size(kFilters) - 1);
  kIer.write(kMailboxEmpty | kFrameWaits | kFrameLost | kBusOff | kErrors);
  kMcr.modify(kInitRequest, kInOrder);
  for (int irq = can_irq::kFirst; irq <= can_irq::kLast; ++irq) {
    core_reg::set_priority(irq, priority::kCan);
    core_reg::enable_interrupt(irq);
  }
}

// The application sends no FD frame by a port without them; one would be dropped, so that the others are sent.
bool can_block::transmit(const wire::CanFrame& f) {
  if (f.fd) return true;
  const std::uint32_t state = kTsr.read();
  if ((state & kAnyEmpty) == 0) return false;
  const std::uint32_t mailbox = kMailboxes + kMailboxBytes * (state >> kNextShift & kNextMask);
  std::uint32_t words[2]{};
  for (std::uint32_t k = 0; k < f.size; ++k) words[k / 4] |= static_cast<std::uint32_t>(f.data[k]) << (8 * (k % 4));
  Register(mailbox + kLength).write(f.size);
  Register(mailbox + kDataLow).write(words[0]);
  Register(mailbox + kDataHigh).write(words[1]);
  Register(mailbox).write(identifier_word(f.extended, f.id) | kTransmit);
  return true;
}

bool can_block::take_frame(wire::CanFrame& f) {
  const std::uint32_t state = kRf0r.read();
  if ((state & kFramesMask) == 0 || (state & kRelease) != 0) return false;
  const std::uint32_t id = Register(kFifo0).read();
  f.extended = (id & kExtended) != 0;
  f.id = f.extended ? id >> kExtendedShift : id >> kStandardShift;
  f.fd = f.bit_rate_switch = false;
  const std::uint32_t length = Register(kFifo0 + kLength).read() & kLengthMask;
  f.size = static_cast<std::uint8_t>(std::min<std::uint32_t>(length, 8));
  const std::uint32_t words[2]{Register(kFifo0 + kDataLow).read(), Register(kFifo0 + kDataHigh).read()};
  for (std::uint32_t k = 0; k < f.size; ++k) f.data[k] = static_cast<std::uint8_t>(words[k / 4] >> (8 * (k % 4)));
  kRf0r.write(kRelease);
  return true;
}

can_block::Events can_block::take_events() {
  Events events;
  kTsr.write(kCompleted);  // Only ones have an effect.
  events.frame_lost = kRf0r.any(kOverrun);
  if (events.frame_lost) kRf0r.write(kOverrun);
  // Bus-off is the only change of state that raises the interrupt.
  events.bus_off = kMsr.any(kErrorInterrupt);
  if (events.bus_off) kMsr.write(kErrorInterrupt);
  return events;
}

// The block leaves bus-off by a visit to initialization.
void can_block::rejoin() {
  kMcr.set(kInitRequest);
  wait_for_init();
  kMcr.clear(kInitRequest);
}

void can_block::describe(wire::BoardHealth& h) {
  const std::uint32_t status = kEsr.read();
  h.can_send_errors = static_cast<std::uint8_t>(status >> kSendErrorsShift & kCounterMask);
  h.can_receive_errors = static_cast<std::uint8_t>(status >> kReceiveErrorsShift & kCounterMask);
  h.can_last_error = static_cast<std::uint8_t>(status >> kLastErrorShift & kLastErrorMask);
  h.can_state = static_cast<std::uint8_t>(((status & kWarning) != 0 ? wire::can_state::kWarning : 0) |
                                          ((status & kPassive) != 0 ? wire::can_state::kErrorPassive : 0) |
                                          ((status & kOff) != 0 ? wire::can_state::kBusOff : 0));
}

}  // namespace triskin::board

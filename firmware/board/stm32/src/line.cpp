// SPDX-License-Identifier: Apache-2.0
#include "line.hpp"

#include "interrupt_timer.hpp"
#include "triskin/board/board.hpp"
#include "triskin/board/budget.hpp"
#include "triskin/board/i2c_timing.hpp"
#include "triskin/board/priorities.hpp"
#include "triskin/board/registers/i2c.hpp"
#include "triskin/board/registers/system.hpp"

namespace triskin::board {

using namespace i2c_reg;

Stm32I2cLine lines[4];

namespace {

constexpr std::uint32_t kInterrupts = kNackInterrupt | kStopInterrupt | kCompleteInterrupt | kErrorInterrupt;
constexpr auto kTiming = compute_i2c_timing({});
static_assert(kTiming.has_value());
// The slack allows for slow edges, clock stretching and interrupt latency in addition to the bytes.
constexpr std::uint64_t kSlack_us = 800;
// The limit is 1.0 ms of SCL low, in units of 2048 clocks.
constexpr std::uint32_t kSclLowTimeout = kSysclk_hz / 1000 / 2048;
// The counters of the DMA do not change while two bytes that it sent ahead, an address and the first byte read are on
// the line: four times 27 µs, and the 1.0 ms for which a chip may hold SCL low after each.
constexpr std::uint64_t kStill_us = 4'200;
constexpr std::uint64_t kHalfPulse_us = 5;  // Bus clear runs at 100 kHz.
// Fast transients come in bursts of 15 ms (IEC 61000-4-4), which may spoil every transfer in them. Single disturbances
// would need 23 losses in a row to last that long, each within the 0.87 ms of a burst of results and its bus clear.
constexpr std::uint64_t kRepeatFor_us = 20'000;
// A disturbed acknowledge bit looks like an absent chip. One disturbance per second spoils the 0.75 ms of a burst of
// results three times in a row once in 2 · 10⁶ seconds. There is room for two: a transfer of a few bytes takes 150
// µs, a refusal about 35 µs, and the schedule reserves 250 µs for both (ReadingSchedule::kShort_us).
constexpr std::uint8_t kMaxRefusals = 2;

std::uint32_t address_of(const void* p) {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(p));
}

void wait_us(std::uint64_t us) {
  const std::uint64_t until = microseconds() + us;
  while (microseconds() < until) {
  }
}

}  // namespace

void open_lines() {
  for (const LinePlace& place : line_places) {
    open_port(place.scl);
    open_port(place.sda);
  }
  connect_lines();
  for (std::size_t k = 0; k < line_places.size(); ++k) lines[k].open(line_places[k]);
}

void Stm32I2cLine::open(const LinePlace& place) {
  place_ = place;
  receiver().connect(place.base + kRxdr);
  sender().connect(place.base + kTxdr);
  pins_to_bus();
  enable();
  for (const int irq : {place.event_irq, place.error_irq}) {
    core_reg::set_priority(irq, priority::kLines);
    core_reg::enable_interrupt(irq);
  }
}

void Stm32I2cLine::pins_to_bus() const {
  for (const Pin pin : {place_.scl, place_.sda}) {
    const Gpio g(pin);
    // The 40 kΩ are in parallel to the line's own pull-up: an unused line must not float, or it looks held low.
    g.pull_up();
    g.open_drain();
    g.alternate(place_.alternate);
    g.mode(PinMode::kAlternate);
  }
}

void Stm32I2cLine::enable() {
  reg(kTimingr).write(kTiming->value());  // The register accepts writes only while the block is off (§39.9.5).
  reg(kTimeoutr).write(kSclLowTimeout);
  reg(kTimeoutr).write(kSclLowTimeout | kTimeoutEnable);
  reg(kCr1).write(kEnable | kInterrupts | kSendByDma | kReceiveByDma);
}

// Clearing PE resets the block; it must stay off for three bus clocks (§39.4.6).
void Stm32I2cLine::disable() {
  reg(kCr1).write(0);
  (void)reg(kCr1).read();
  (void)reg(kCr1).read();
  (void)reg(kCr1).read();
  reg(kTimeoutr).write(0);
}

void Stm32I2cLine::start(std::uint8_t address, Bytes write, std::span<std::uint8_t> read) {
  write_ = write;
  read_ = read;
  address_ = address;
  refusals_ = 0;
  active_ = true;
  started_us_ = microseconds();
  begin_transfer();
}

void Stm32I2cLine::begin_transfer() {
  nack_ = false;
  reading_ = write_.empty();
  outcome_ = Outcome::kRunning;
  left_ = write_.size() + read_.size();
  deadline_us_ = microseconds() + (write_.size() + read_.size() + 2) * 23 + kSlack_us;
  if (reading_) return begin_reading();
  asm volatile("dmb" ::: "memory");  // The buffer must be written before the DMA reads it.
  sender().start(address_of(write_.data()), write_.size(), true);
  reg(kCr2).write(static_cast<std::uint32_t>(address_) << 1 | static_cast<std::uint32_t>(write_.size()) << kBytesShift |
                  (read_.empty() ? kAutoEnd : 0U) | kStart);
}

void Stm32I2cLine::begin_reading() {
  receiver().start(address_of(read_.data()), read_.size(), false);
  reg(kCr2).write(static_cast<std::uint32_t>(address_) << 1 | kRead |
                  static_cast<std::uint32_t>(read_.size()) << kBytesShift | kAutoEnd | kStart);
}

void Stm32I2cLine::on_event() {
  const std::uint32_t status = reg(kIsr).read();
  if ((status & kNack) != 0) {
    reg(kIcr).write(kNack);  // The block sends the stop by itself.
    sender().stop();
    reg(kIsr).write(kTxFlush);  // A byte that the DMA has already put there would start the next transfer.
    nack_ = true;
  }
  if ((status & kComplete) != 0 && !reading_) {
    reading_ = true;
    begin_reading();
  }
  if ((status & kStopSeen) != 0) {
    reg(kIcr).write(kStopSeen);
    end(nack_ ? Outcome::kNack : Outcome::kDone);
  }
}

void Stm32I2cLine::on_error() {
  const std::uint32_t status = reg(kIsr).read();
  reg(kIcr).write(kBusError | kArbitrationLost | kTimeout);
  // The block may report a bus error where there is none; the transfer continues (errata ES0430, 2.15.2).
  if ((status & kBusError) != 0) ++triskin_budget.bus_errors;
  if ((status & kTimeout) != 0) return end(Outcome::kStuck);
  if ((status & kArbitrationLost) != 0) {
    ++triskin_budget.arbitration_losses;
    end(Outcome::kLost);
  }
}

void Stm32I2cLine::end(Outcome outcome) {
  if (outcome_ != Outcome::kRunning) return;
  ended_us_ = microseconds();
  outcome_ = outcome;
}

std::optional<Status> Stm32I2cLine::poll() {
  if (!active_) return std::nullopt;
  if (outcome_ == Outcome::kRunning) {
    if (microseconds() < deadline_us_ || moves()) return std::nullopt;
    end(Outcome::kStuck);
  }
  if (outcome_ == Outcome::kLost && repeat()) return std::nullopt;
  if (outcome_ == Outcome::kNack && refusals_++ < kMaxRefusals) {
    begin_again();
    return std::nullopt;
  }
  active_ = false;
  const bool whole = (reading_ ? receiver() : sender()).remaining() == 0;
  receiver().stop();
  sender().stop();
  asm volatile("dmb" ::: "memory");  // Data that the DMA wrote must be read after this.
  if (outcome_ == Outcome::kStuck || outcome_ == Outcome::kLost) {
    disable();
    enable();
    return Status::kLineStuck;
  }
  if (outcome_ == Outcome::kNack) return Status::kBusError;
  return whole ? Status::kOk : Status::kBusError;
}

// A chip that sometimes holds SCL low delays a transfer; one that hangs moves no byte.
bool Stm32I2cLine::moves() {
  const std::size_t left = reading_ ? receiver().remaining() : sender().remaining() + read_.size();
  if (left == left_) return false;
  left_ = left;
  deadline_us_ = microseconds() + kStill_us;
  return true;
}

// There is no other master, so a disturbance looked like one. The bus counts as busy and a chip may hold it in the
// middle of a byte, so it is cleared and the transfer repeated. The line is stuck when clearing does not free it, or
// when the disturbance lasts longer than any transient.
bool Stm32I2cLine::repeat() {
  if (microseconds() - started_us_ >= kRepeatFor_us || recover() != Status::kOk) return false;
  begin_again();
  return true;
}

void Stm32I2cLine::begin_again() {
  receiver().stop();
  sender().stop();
  begin_transfer();
}

// Clears the bus (UM10204 §3.1.16) manually: up to nine pulses until SDA is free, then a stop. Takes at most 120 µs.
Status Stm32I2cLine::recover() {
  disable();
  const Gpio scl(place_.scl), sda(place_.sda);
  scl.drive(true);
  sda.drive(true);
  scl.mode(PinMode::kOutput);
  sda.mode(PinMode::kOutput);
  for (int pulse = 0; pulse < 9 && !sda.level(); ++pulse) {
    scl.drive(false);
    wait_us(kHalfPulse_us);
    scl.drive(true);
    wait_us(kHalfPulse_us);
  }
  scl.drive(false);  // SDA must rise while SCL is high, which is a stop.
  sda.drive(false);
  wait_us(kHalfPulse_us);
  scl.drive(true);
  wait_us(kHalfPulse_us);
  sda.drive(true);
  wait_us(kHalfPulse_us);
  const bool free = scl.level() && sda.level();
  pins_to_bus();
  enable();
  return free ? Status::kOk : Status::kLineStuck;
}

}  // namespace triskin::board

extern "C" {
#define TRISKIN_LINE_HANDLERS(n)                \
  void i2c##n##_event_handler() {               \
    const triskin::board::InterruptTimer timer; \
    triskin::board::lines[n - 1].on_event();    \
  }                                             \
  void i2c##n##_error_handler() {               \
    const triskin::board::InterruptTimer timer; \
    triskin::board::lines[n - 1].on_error();    \
  }
TRISKIN_LINE_HANDLERS(1)
TRISKIN_LINE_HANDLERS(2)
TRISKIN_LINE_HANDLERS(3)
TRISKIN_LINE_HANDLERS(4)
}

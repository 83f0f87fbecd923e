// SPDX-License-Identifier: Apache-2.0
#include "line.hpp"

#include "interrupt_timer.hpp"
#include "triskin/board/board.hpp"
#include "triskin/board/i2c_timing.hpp"
#include "triskin/board/registers/i2c.hpp"
#include "triskin/board/registers/system.hpp"

namespace triskin::board {

using namespace i2c_reg;

Stm32I2cLine lines[4];

namespace {

constexpr LinePlace kPlaces[4] = {
    {0x40005400, {'A', 15}, {'B', 7}, 4, 31, 32},
    {0x40005800, {'A', 9}, {'A', 8}, 4, 33, 34},
    {0x40007800, {'C', 8}, {'C', 9}, 8, 92, 93},
    {0x40008400, {'C', 6}, {'C', 7}, 8, 82, 83},
};
constexpr std::uint32_t kInterrupts = kTxInterrupt | kRxInterrupt | kNackInterrupt | kStopInterrupt | kCompleteInterrupt | kErrorInterrupt;
constexpr auto kTiming = compute_i2c_timing({});
static_assert(kTiming.has_value());
constexpr std::uint64_t kSlack_us = 500;         // above the bytes: clock stretching and interrupt latency
constexpr std::uint32_t kSclLowTimeout = 82;           // (82 + 1) · 2048 / 170 MHz = 1.0 ms of SCL low
constexpr std::uint64_t kHalfPulse_us = 5;       // bus clear at 100 kHz

void wait_us(std::uint64_t us) {
  const std::uint64_t until = microseconds() + us;
  while (microseconds() < until) {
  }
}

}  // namespace

void open_lines() {
  rcc_reg::kAhb2Enr.set(rcc_reg::kGpioA | rcc_reg::kGpioB | rcc_reg::kGpioC);
  rcc_reg::kApb1Enr1.set(rcc_reg::kI2c1 | rcc_reg::kI2c2 | rcc_reg::kI2c3);
  rcc_reg::kApb1Enr2.set(rcc_reg::kI2c4);
  (void)rcc_reg::kApb1Enr2.read();
  for (int k = 0; k < 4; ++k) lines[k].open(kPlaces[k]);
}

void Stm32I2cLine::open(const LinePlace& place) {
  place_ = place;
  pins_to_bus();
  enable();
  for (const int irq : {place.event_irq, place.error_irq}) {
    core_reg::set_priority(irq, 0x40);
    core_reg::enable_interrupt(irq);
  }
}

void Stm32I2cLine::pins_to_bus() const {
  for (const Pin pin : {place_.scl, place_.sda}) {
    const Gpio g(pin);
    g.open_drain();
    g.alternate(place_.alternate);
    g.mode(PinMode::kAlternate);
  }
}

void Stm32I2cLine::enable() {
  reg(kTimingr).write(kTiming->value());  // only while the block is off (§41.9.5)
  reg(kTimeoutr).write(kSclLowTimeout);
  reg(kTimeoutr).write(kSclLowTimeout | kTimeoutEnable);
  reg(kCr1).write(kEnable | kInterrupts);
}

// Clearing PE is the block's reset; it must stay off for three bus clocks (§41.4.6).
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
  at_ = 0;
  nack_ = false;
  reading_ = write.empty();
  outcome_ = Outcome::kRunning;
  const std::uint64_t bytes = write.size() + read.size() + 2;
  deadline_us_ = microseconds() + bytes * 23 + kSlack_us;
  active_ = true;
  const std::uint32_t target = static_cast<std::uint32_t>(address) << 1;
  if (reading_) {
    reg(kCr2).write(target | kRead | static_cast<std::uint32_t>(read.size()) << kBytesShift | kAutoEnd | kStart);
  } else {
    reg(kCr2).write(target | static_cast<std::uint32_t>(write.size()) << kBytesShift | (read.empty() ? kAutoEnd : 0U) | kStart);
  }
}

void Stm32I2cLine::on_event() {
  const std::uint32_t status = reg(kIsr).read();
  if ((status & kNack) != 0) {
    reg(kIcr).write(kNack);  // the block sends the stop by itself
    nack_ = true;
  }
  if ((status & kTxEmpty) != 0 && !nack_) reg(kTxdr).write(at_ < write_.size() ? write_[at_++] : 0xFF);
  if ((status & kRxFull) != 0) {
    const auto byte = static_cast<std::uint8_t>(reg(kRxdr).read());
    if (at_ < read_.size()) read_[at_++] = byte;
  }
  if ((status & kComplete) != 0 && !reading_) {
    reading_ = true;
    at_ = 0;
    reg(kCr2).write(static_cast<std::uint32_t>(address_) << 1 | kRead | static_cast<std::uint32_t>(read_.size()) << kBytesShift | kAutoEnd | kStart);
  }
  if ((status & kStopSeen) != 0) {
    reg(kIcr).write(kStopSeen);
    end(nack_ ? Outcome::kNack : Outcome::kDone);
  }
}

void Stm32I2cLine::on_error() {
  reg(kIcr).write(kBusError | kArbitrationLost | kTimeout);
  end(Outcome::kStuck);
}

void Stm32I2cLine::end(Outcome outcome) {
  if (outcome_ == Outcome::kRunning) outcome_ = outcome;
}

std::optional<Status> Stm32I2cLine::poll() {
  if (!active_) return std::nullopt;
  if (outcome_ == Outcome::kRunning) {
    if (microseconds() < deadline_us_) return std::nullopt;
    end(Outcome::kStuck);
  }
  active_ = false;
  if (outcome_ == Outcome::kStuck) {
    disable();
    enable();
    return Status::kLineStuck;
  }
  if (outcome_ == Outcome::kNack) return Status::kBusError;
  return at_ == (reading_ ? read_.size() : write_.size()) ? Status::kOk : Status::kBusError;
}

// Bus clear (UM10204 §3.1.16) by hand: up to nine pulses until SDA is free, then a stop. At most 120 µs.
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
  scl.drive(false);  // stop: SDA rises while SCL is high
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
#define TRISKIN_LINE_HANDLERS(n)                             \
  void i2c##n##_event_handler() {                            \
    const triskin::board::InterruptTimer timer;              \
    triskin::board::lines[n - 1].on_event();                 \
  }                                                          \
  void i2c##n##_error_handler() {                            \
    const triskin::board::InterruptTimer timer;              \
    triskin::board::lines[n - 1].on_error();                 \
  }
TRISKIN_LINE_HANDLERS(1)
TRISKIN_LINE_HANDLERS(2)
TRISKIN_LINE_HANDLERS(3)
TRISKIN_LINE_HANDLERS(4)
}

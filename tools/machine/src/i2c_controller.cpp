// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/machine/i2c_controller.hpp"

#include <fmt/format.h>

#include <utility>

namespace triskin::machine {
namespace {

constexpr std::uint32_t kTxEmpty = 1, kTxIs = 2, kRxNe = 4, kNack = 16, kStop = 32, kTc = 64, kBusError = 1U << 8,
                        kArbitrationLost = 1U << 9, kTimeout = 1U << 12, kBusy = 1U << 15;
constexpr double kRiseToHigh = 1.2040 / 0.8473;
constexpr std::uint32_t kStartBit = 1U << 13, kStopBit = 1U << 14, kAutoEnd = 1U << 25, kReadBit = 1U << 10;

}  // namespace

void I2cController::reset() {
  ++generation_;
  cr1_ = cr2_ = timing_ = timeout_ = 0;
  isr_ = kTxEmpty;
  tx_waits_ = shifting_ = stretched_ = on_bus_ = spoilt_ = false;
  stretch_ = 0;
  update_irqs();
}

// The period is SCLL + SCLH and the synchronization of both edges: filter 50 ns and two kernel clocks each (§39.4.10).
// The high time is counted from where the pin reads high: a line that charges through its pull-up is at 70 % after ln(1
// / 0.3) of its time constant, and takes ln(0.7 / 0.3) of it from 30 to 70 %.
Time I2cController::scl_period() const {
  const Time clock = kSecond / around_.sysclk_hz();
  const Time unit = ((timing_ >> 28) + 1) * clock;
  return ((timing_ & 255) + 1 + (timing_ >> 8 & 255) + 1) * unit + 2 * (50'000 + 2 * clock) +
         static_cast<Time>(kRiseToHigh * rise_ns_ * 1000);
}

// Fast mode requires SCL low for 1.3 µs and high for 0.6 µs, and no more than 400 kHz (UM10204 table 10).
void I2cController::check_timing() {
  const Time unit = ((timing_ >> 28) + 1) * (kSecond / around_.sysclk_hz());
  const Time low = ((timing_ & 255) + 1) * unit, high = ((timing_ >> 8 & 255) + 1) * unit;
  if (low < 1'300'000 || high < 600'000 || scl_period() < 2'499'000) {
    around_.violation(fmt::format("I2C{}: SCL low {} ns, high {} ns, period {} ns break fast mode", line_ + 1,
                                  low / 1000, high / 1000, scl_period() / 1000));
  }
}

void I2cController::after(Time delay, std::function<void()> action) {
  around_.time().after(delay, [this, g = generation_, action = std::move(action)] {
    if (g != generation_) return;
    action();
    update_irqs();
  });
}

// With DMA on, bytes move without the processor (§39.7).
void I2cController::serve_dma() {
  constexpr std::uint32_t kTxDma = 1U << 14, kRxDma = 1U << 15;
  while ((cr1_ & kTxDma) != 0 && (isr_ & kTxIs) != 0) {
    const auto byte = dma_.fetch(receive_request() + 1);
    if (!byte) break;
    load(*byte);
  }
  while ((cr1_ & kRxDma) != 0 && (isr_ & kRxNe) != 0 && dma_.wants(receive_request()))
    dma_.store(receive_request(), take_received());
}

std::uint8_t I2cController::take_received() {
  const std::uint8_t value = rx_;
  isr_ &= ~kRxNe;
  if (std::exchange(stretched_, false)) deliver();
  return value;
}

void I2cController::load(std::uint8_t byte) {
  tx_ = byte;
  tx_waits_ = true;
  isr_ &= ~kTxIs;
  ++loaded_;
  if (!shifting_) shift_out();
}

void I2cController::update_irqs() {
  serve_dma();
  std::uint32_t flags = 0;
  for (const unsigned k : {1U, 2U, 4U, 5U, 6U}) {
    if ((cr1_ >> k & 1) != 0) flags |= isr_ & (1U << k);
  }
  around_.set_irq(event_irq_, flags != 0);
  around_.set_irq(error_irq_, (cr1_ >> 7 & 1) != 0 && (isr_ & (kBusError | kArbitrationLost | kTimeout)) != 0);
}

bool I2cController::spurious_bus_error() {
  if (!on_bus_ || (cr1_ & 1) == 0 || (isr_ & kBusError) != 0) return false;
  isr_ |= kBusError;
  update_irqs();
  return true;
}

// Arbitration can only be lost while SCL is high. A master that waits for its program keeps SCL low: before a repeated
// start, or for a byte to send, or until a byte is taken.
bool I2cController::holds_scl() const {
  return (isr_ & kTc) != 0 || stretched_ || (!shifting_ && (isr_ & kTxIs) != 0);
}

bool I2cController::lose_arbitration() {
  if (!on_bus_ || (cr1_ & 1) == 0 || holds_scl()) return false;
  ++generation_;  // The new generation cancels all pending events.
  cr2_ &= ~kStartBit;
  tx_waits_ = shifting_ = stretched_ = on_bus_ = spoilt_ = false;
  busy_time_ += around_.time().now() - busy_since_;
  isr_ = (isr_ & ~(kTxIs | kTc)) | kArbitrationLost | kBusy;
  update_irqs();
  return true;
}

bool I2cController::spoil_acknowledge() {
  const bool address_to_come = (cr2_ & kStartBit) != 0, bytes_to_come = !reading_ && moved_ < count_;
  if (!on_bus_ || spoilt_ || !(address_to_come || bytes_to_come)) return false;
  spoilt_ = true;
  return true;
}

bool I2cController::stretch(Time by) {
  if (!on_bus_ || stretch_ != 0) return false;
  stretch_ = by;
  return true;
}

std::uint32_t I2cController::read(std::uint32_t offset, unsigned) {
  switch (offset) {
    case 0x00:
      return cr1_;
    case 0x04:
      return cr2_;
    case 0x10:
      return timing_;
    case 0x14:
      return timeout_;
    case 0x18:
      return isr_;
    case 0x24: {
      if ((isr_ & kRxNe) == 0) around_.violation(fmt::format("I2C{}: RXDR read while empty", line_ + 1));
      const std::uint8_t value = take_received();
      update_irqs();
      return value;
    }
    default:
      return 0;
  }
}

void I2cController::write(std::uint32_t offset, std::uint32_t value, unsigned) {
  switch (offset) {
    case 0x00:
      if ((value & 1) == 0 && (cr1_ & 1) != 0) {
        const std::uint32_t timing = timing_, timeout = timeout_;
        reset();
        timing_ = timing;
        timeout_ = timeout;
      }
      if ((value & 1) != 0 && (cr1_ & 1) == 0) check_timing();
      cr1_ = value;
      break;
    case 0x04:
      write_control2(value);
      break;
    case 0x10:
      if ((cr1_ & 1) != 0)
        around_.violation(fmt::format("I2C{}: TIMINGR written while enabled", line_ + 1));
      else
        timing_ = value;
      break;
    case 0x14:
      if ((timeout_ & 0x8000) != 0 && (value & 0x8000) != 0)
        around_.violation(fmt::format("I2C{}: TIMEOUTA changed while it counts", line_ + 1));
      timeout_ = value;
      break;
    case 0x18:  // Writing TXE as 1 empties the data register.
      if ((value & 1) != 0) tx_waits_ = false;
      break;
    case 0x1C:
      isr_ &= ~(value & 0x3F38);
      break;
    case 0x28:
      if ((isr_ & kTxIs) == 0) {
        around_.violation(fmt::format("I2C{}: TXDR written when it was not empty", line_ + 1));
        break;
      }
      load(static_cast<std::uint8_t>(value));
      break;
    default:
      around_.violation(fmt::format("I2C{} register {:#x} is not modelled", line_ + 1, offset));
  }
  update_irqs();
}

void I2cController::write_control2(std::uint32_t value) {
  if ((cr1_ & 1) == 0 && (value & (kStartBit | kStopBit)) != 0) {
    around_.violation(fmt::format("I2C{}: start while the block is off", line_ + 1));
    return;
  }
  if ((cr2_ & kStartBit) != 0) {
    around_.violation(fmt::format("I2C{}: CR2 written while a start is pending", line_ + 1));
    return;
  }
  cr2_ = value;
  if ((value & kStartBit) != 0) begin();
}

void I2cController::begin() {
  reading_ = (cr2_ & kReadBit) != 0;
  count_ = cr2_ >> 16 & 255;
  loaded_ = moved_ = 0;
  if ((isr_ & kBusy) != 0 && !on_bus_) {
    around_.violation(fmt::format("I2C{}: start after lost arbitration before the bus was cleared", line_ + 1));
    return;
  }
  if (tx_waits_)
    around_.violation(fmt::format("I2C{}: start while TXDR still holds a byte of the transfer before", line_ + 1));
  tx_waits_ = shifting_ = stretched_ = false;
  isr_ = (isr_ & ~(kTc | kTxIs | kRxNe)) | kBusy;
  if (!pins_ready_())
    around_.violation(fmt::format("I2C{}: start while a pin is not its open-drain alternate function", line_ + 1));
  if (others_busy_ && others_busy_())
    around_.violation(fmt::format("I2C{}: start while another master drives the same SCL", line_ + 1));
  if (!std::exchange(on_bus_, true)) busy_since_ = around_.time().now();
  if (!lines_free()) {
    hang();
    return;
  }
  if (trace_ != nullptr) trace_->i2c_start(line_, around_.time().now());
  after(scl_period() * 10, [this] { address_sent(); });  // The time covers the start condition and nine bits.
}

// The bus hangs. With SCL low the time-out counter reports it; with SDA low nothing does.
void I2cController::hang() {
  if (bus_.scl() || (timeout_ & 0x8000) == 0) return;
  const Time wait = Time{(timeout_ & 0xFFF) + 1} * 2048 * kSecond / around_.sysclk_hz();
  after(wait, [this] { isr_ |= kTimeout; });
}

void I2cController::address_sent() {
  const auto address = static_cast<std::uint8_t>((cr2_ & 0xFE) | (reading_ ? 1 : 0));
  const bool acknowledged = bus_.start(address, around_.time().now_us()) && !std::exchange(spoilt_, false);
  if (!lines_free()) {
    hang();
    return;
  }
  cr2_ &= ~kStartBit;
  if (trace_ != nullptr) trace_->i2c_byte(line_, address, acknowledged, around_.time().now(), scl_period());
  if (!acknowledged) {
    isr_ |= kNack;
    send_stop();
  } else if (count_ == 0) {
    finish_phase();
  } else if (reading_) {
    shift_in();
  } else {
    isr_ |= kTxIs;
  }
}

void I2cController::shift_out() {
  shifting_ = true;
  tx_waits_ = false;
  if (loaded_ < count_) isr_ |= kTxIs;
  after(scl_period() * 9 + std::exchange(stretch_, 0), [this, byte = tx_] {
    shifting_ = false;
    const bool acknowledged = bus_.write(byte, around_.time().now_us()) && !std::exchange(spoilt_, false);
    if (!lines_free()) return hang();
    if (trace_ != nullptr) trace_->i2c_byte(line_, byte, acknowledged, around_.time().now(), scl_period());
    ++moved_;
    if (!acknowledged) {
      isr_ = (isr_ & ~kTxIs) | kNack;
      send_stop();
    } else if (moved_ == count_) {
      finish_phase();
    } else if (tx_waits_) {
      shift_out();
    }
  });
}

void I2cController::shift_in() {
  after(scl_period() * 9 + std::exchange(stretch_, 0), [this] {
    const bool more = moved_ + 1 < count_;
    held_ = bus_.read(more, around_.time().now_us());
    if (!lines_free()) return hang();
    if (trace_ != nullptr) trace_->i2c_byte(line_, held_, more, around_.time().now(), scl_period());
    ++moved_;
    if ((isr_ & kRxNe) != 0)
      stretched_ = true;  // Nobody has taken the byte before, so SCL stays low.
    else
      deliver();
  });
}

// The byte goes to the data register while the next one arrives.
void I2cController::deliver() {
  rx_ = held_;
  isr_ |= kRxNe;
  if (moved_ < count_)
    shift_in();
  else
    finish_phase();
}

void I2cController::finish_phase() {
  if ((cr2_ & kAutoEnd) != 0)
    send_stop();
  else
    isr_ |= kTc;
}

void I2cController::send_stop() {
  after(scl_period(), [this] {
    bus_.stop(around_.time().now_us());
    if (trace_ != nullptr) trace_->i2c_stop(line_, around_.time().now());
    isr_ = (isr_ & ~kBusy) | kStop;
    if (std::exchange(on_bus_, false)) busy_time_ += around_.time().now() - busy_since_;
  });
}

}  // namespace triskin::machine

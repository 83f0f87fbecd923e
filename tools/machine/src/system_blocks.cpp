// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/machine/system_blocks.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace triskin::machine {

void Pwr::reset() {
  regs_ = {};
  regs_[0] = 0x200;  // The voltage range is 1.
  regs_[0x80 / 4] = 0x100;
}

void Pwr::write(std::uint32_t offset, std::uint32_t value, unsigned) {
  regs_[offset / 4 & 63] = value;
  if (offset == 0x80) rcc_.set_boost((value & 0x100) == 0);
}

void Tim16::reset() {
  regs_ = {};
  started_ = 0;
  captured_ = 0;
}

bool Tim16::captures() const {
  constexpr std::uint32_t kFromInput = 1, kEighth = 3U << 2, kCrystalBy32 = 3;
  return (regs_[0] & 1) != 0 && (regs_[0x20 / 4] & 1) != 0 && regs_[0x18 / 4] == (kFromInput | kEighth) &&
         regs_[0x5C / 4] == kCrystalBy32 && rcc_.crystal_hz() != 0;
}

// Takes the edges since the last call: the count of the last one stays, and a flag tells when it overwrote one.
void Tim16::catch_up() {
  if (!captures()) return;
  const Time since = around_.time().now() - started_;
  const double per_edge = 8.0 * 32.0 * static_cast<double>(kSecond) / static_cast<double>(rcc_.crystal_hz());
  const auto edges = static_cast<std::uint64_t>(static_cast<double>(since) / per_edge);
  if (edges == captured_) return;
  const bool unread = (regs_[0x10 / 4] & 2) != 0 || edges > captured_ + 1;
  captured_ = edges;
  const auto at = static_cast<Time>(per_edge * static_cast<double>(edges));
  regs_[0x34 / 4] = static_cast<std::uint32_t>(at / (kSecond / around_.sysclk_hz())) & 0xFFFF;
  regs_[0x10 / 4] |= 2 | (unread ? 1U << 9 : 0U);
}

std::uint32_t Tim16::read(std::uint32_t offset, unsigned) {
  catch_up();
  const std::uint32_t value = regs_[offset / 4 & 63];
  if (offset == 0x34) regs_[0x10 / 4] &= ~2U;
  return value;
}

void Tim16::write(std::uint32_t offset, std::uint32_t value, unsigned) {
  const bool was_on = (regs_[0] & 1) != 0;
  regs_[offset / 4 & 63] = offset == 0x10 ? regs_[0x10 / 4] & value : value;
  if (offset == 0 && !was_on && (value & 1) != 0) {
    started_ = around_.time().now();
    captured_ = 0;
  }
}

void Tim2::reset() {
  ++generation_;
  control_ = interrupts_ = status_ = prescaler_ = prescaler_next_ = 0;
  compare_ = {};
  update_irq();
}

std::uint64_t Tim2::count() const {
  if ((control_ & 1) == 0) return 0;
  const std::uint64_t hz = around_.sysclk_hz() / (prescaler_ + 1);
  return (std::min(around_.time().now(), still_since_) - base_) / (kSecond / hz);
}

void Tim2::stand(bool still) {
  if (still == (still_since_ != kNever)) return;
  const Time now = around_.time().now();
  if (still) {
    still_since_ = now;
  } else {
    base_ += now - still_since_;
    still_since_ = kNever;
  }
  book_compare();
}

void Tim2::book_compare() {
  ++generation_;
  if ((control_ & 1) == 0 || still_since_ != kNever) return;
  for (std::size_t channel = 0; channel < compare_.size(); ++channel) book_compare(channel);
}

void Tim2::book_compare(std::size_t channel) {
  const std::uint32_t flag = 2U << channel;
  if ((interrupts_ & flag) == 0) return;
  const auto ahead = static_cast<std::uint32_t>(compare_[channel] - static_cast<std::uint32_t>(count()));
  const Time unit = kSecond / (around_.sysclk_hz() / (prescaler_ + 1));
  const Time phase = (around_.time().now() - base_) % unit;
  const Time wait = (ahead == 0 ? Time{1} << 32 : Time{ahead}) * unit - phase;
  around_.time().after(wait, [this, flag, generation = generation_] {
    if (generation != generation_) return;
    status_ |= flag;
    update_irq();
  });
}

std::uint32_t Tim2::read(std::uint32_t offset, unsigned) {
  switch (offset) {
    case 0x00:
      return control_;
    case 0x0C:
      return interrupts_;
    case 0x10:
      return status_;
    case 0x24:
      return static_cast<std::uint32_t>(count());
    case 0x28:
      return prescaler_next_;
    case 0x2C:
      return 0xFFFFFFFF;
    case 0x34:
    case 0x38:
      return compare_[(offset - 0x34) / 4];
    default:
      return 0;
  }
}

void Tim2::write(std::uint32_t offset, std::uint32_t value, unsigned) {
  switch (offset) {
    case 0x00:
      if ((value & 1) != 0 && (control_ & 1) == 0) base_ = around_.time().now();
      control_ = value;
      break;
    case 0x0C:
      interrupts_ = value;
      break;
    case 0x10:
      status_ &= value;
      break;
    case 0x14:
      if ((value & 1) != 0) {
        prescaler_ = prescaler_next_;
        base_ = around_.time().now();
      }
      status_ |= value & 6;
      break;
    case 0x28:
      prescaler_next_ = value & 0xFFFF;
      break;
    case 0x2C:
      if (value != 0xFFFFFFFF) around_.violation("TIM2_ARR: only the full period is modelled");
      break;
    case 0x34:
    case 0x38:
      compare_[(offset - 0x34) / 4] = value;
      break;
    default:
      around_.violation(fmt::format("TIM2 register {:#x} is not modelled", offset));
  }
  book_compare();
  update_irq();
}

void Iwdg::reset() {
  ++generation_;
  running_ = unlocked_ = false;
  prescaler_ = 0;
  reload_ = 0xFFF;
}

void Iwdg::reload() {
  const Time unit = kSecond / 32'000 * (Time{4} << prescaler_);
  book(static_cast<Time>(static_cast<double>(unit * (reload_ + 1)) / (1 + error_)));
}

void Iwdg::book(Time left) {
  const std::uint64_t generation = ++generation_;
  left_ = left;
  if (still_) return;
  due_ = around_.time().now() + left;
  around_.time().after(left, [this, generation] {
    if (generation == generation_) around_.request_reset(1U << 29);
  });
}

void Iwdg::stand(bool still) {
  if (still == still_) return;
  still_ = still;
  if (!running_) return;
  if (still) {
    ++generation_;
    left_ = due_ - around_.time().now();
  } else {
    book(left_);
  }
}

void DebugUnit::write(std::uint32_t offset, std::uint32_t value, unsigned) {
  if (offset != kApb1Freeze) return around_.violation(fmt::format("DBGMCU register {:#x} is not modelled", offset));
  freeze_ = value;
}

std::uint32_t Iwdg::read(std::uint32_t offset, unsigned) {
  return offset == 0x04 ? prescaler_ : offset == 0x08 ? reload_ : 0;
}

void Iwdg::write(std::uint32_t offset, std::uint32_t value, unsigned) {
  if (offset == 0x00) {
    unlocked_ = value == 0x5555;
    if (value == 0xCCCC) running_ = true;
    if ((value == 0xAAAA || value == 0xCCCC) && running_) reload();
    return;
  }
  if (!unlocked_) {
    around_.violation("IWDG register written without its key");
    return;
  }
  if (offset == 0x04) prescaler_ = value & 7;
  if (offset == 0x08) reload_ = value & 0xFFF;
}

}  // namespace triskin::machine

// SPDX-License-Identifier: GPL-3.0-or-later
#include "system_blocks.hpp"

#include <fmt/format.h>

namespace triskin::machine {
namespace {

constexpr Time kCrystalStart = 2000 * kMicrosecond, kPllStart = 40 * kMicrosecond, kHsi48Start = 6 * kMicrosecond;
constexpr std::uint32_t kCr = 0x00, kCfgr = 0x08, kPllCfgr = 0x0C, kCsr = 0x94, kCrrcr = 0x98;
constexpr std::uint64_t kCrystal_hz = 8'000'000, kHsi_hz = 16'000'000;

}  // namespace

void Rcc::reset() {
  ++generation_;
  regs_ = {};
  regs_[kCr / 4] = 0x500;  // HSI on and ready
  regs_[kCfgr / 4] = 5;
  regs_[kPllCfgr / 4] = 0x1000;
  regs_[map::kAhb1 / 4] = 1U << map::kFlashBit;
  regs_[map::kApb1 / 4] = 0x400;  // bus clock of the RTC
  sysclk_hz_ = kHsi_hz;
  wait_states_ = 0;
  boost_ = false;
}

std::uint32_t Rcc::read(std::uint32_t offset, unsigned) {
  return offset == kCsr ? csr_flags_ : regs_[offset / 4 & 63];
}

void Rcc::write_control(std::uint32_t value) {
  constexpr std::uint32_t kReadOnly = 1U << 10 | 1U << 17 | 1U << 25;
  std::uint32_t& cr = regs_[kCr / 4];
  const std::uint32_t before = cr;
  cr = (value & ~kReadOnly) | (before & kReadOnly);
  const auto start = [&](unsigned on, unsigned ready, Time delay) {
    if ((cr >> on & 1) == 0)
      cr &= ~(1U << ready);
    else if ((before >> on & 1) == 0) {
      around_.time().after(delay, [this, ready, g = generation_] {
        if (g == generation_) regs_[kCr / 4] |= 1U << ready;
      });
    }
  };
  if (crystal_works_) start(16, 17, kCrystalStart);
  start(24, 25, kPllStart);
}

// What the clock tree gives, and the rules for going fast: wait states, boost, AHB halved in between.
void Rcc::switch_clock() {
  std::uint32_t& cfgr = regs_[kCfgr / 4];
  const std::uint32_t wanted = cfgr & 3;
  const std::uint32_t cr = regs_[kCr / 4];
  const bool ready = wanted == 1 || (wanted == 2 && (cr >> 17 & 1) != 0) || (wanted == 3 && (cr >> 25 & 1) != 0);
  if (!ready) {
    around_.violation("RCC_CFGR.SW names a clock that is not ready");
    return;
  }
  const bool was_pll = (cfgr >> 2 & 3) == 3;
  cfgr = (cfgr & ~0xCU) | wanted << 2;
  std::uint64_t hz = wanted == 1 ? kHsi_hz : kCrystal_hz;
  if (wanted == 3) {
    const std::uint32_t pll = regs_[kPllCfgr / 4];
    hz = (pll & 3) == 3 ? kCrystal_hz : kHsi_hz;
    hz = hz / ((pll >> 4 & 15) + 1) * (pll >> 8 & 127) / (2 * ((pll >> 25 & 3) + 1));
    if ((pll >> 24 & 1) == 0) around_.violation("RCC_PLLCFGR.PLLREN is off: the PLL has no output");
    if (hz > 170'000'000) around_.violation(fmt::format("SYSCLK of {} Hz", hz));
    if (!was_pll && hz > 80'000'000 && (cfgr & 0xF0) == 0)
      around_.violation("switched above 80 MHz without halving the AHB clock");
    if (hz > 150'000'000 && !boost_) around_.violation("above 150 MHz without PWR_CR5 boost");
    if (hz > (wait_states_ + 1) * 34'000'000ULL)
      around_.violation(fmt::format("{} flash wait states at {} Hz", wait_states_, hz));
  }
  sysclk_hz_ = (cfgr & 0xF0) == 0x80 ? hz / 2 : hz;
}

void Rcc::write(std::uint32_t offset, std::uint32_t value, unsigned) {
  switch (offset) {
    case kCr:
      write_control(value);
      return;
    case kCfgr:
      regs_[kCfgr / 4] = (value & ~0xCU) | (regs_[kCfgr / 4] & 0xCU);
      switch_clock();
      return;
    case kPllCfgr:
      if ((regs_[kCr / 4] >> 24 & 1) != 0)
        around_.violation("RCC_PLLCFGR written while the PLL runs");
      else
        regs_[kPllCfgr / 4] = value;
      return;
    case kCsr:
      if ((value >> 23 & 1) != 0) csr_flags_ = 0;
      return;
    case kCrrcr:
      regs_[kCrrcr / 4] = (value & 1) == 0 ? 0 : (regs_[kCrrcr / 4] & 2) | 1;
      if ((value & 1) == 0) return;
      around_.time().after(kHsi48Start, [this, g = generation_] {
        if (g == generation_ && (regs_[kCrrcr / 4] & 1) != 0) regs_[kCrrcr / 4] |= 2;
      });
      return;
    default:
      regs_[offset / 4 & 63] = value;
  }
}

void Pwr::reset() {
  regs_ = {};
  regs_[0] = 0x200;  // range 1
  regs_[0x80 / 4] = 0x100;
}

void Pwr::write(std::uint32_t offset, std::uint32_t value, unsigned) {
  regs_[offset / 4 & 63] = value;
  if (offset == 0x80) rcc_.set_boost((value & 0x100) == 0);
}

void Tim2::reset() {
  ++generation_;
  control_ = interrupts_ = status_ = prescaler_ = prescaler_next_ = compare_ = 0;
  update_irq();
}

std::uint64_t Tim2::count() const {
  if ((control_ & 1) == 0) return 0;
  const std::uint64_t hz = around_.sysclk_hz() / (prescaler_ + 1);
  return (around_.time().now() - base_) / (kSecond / hz);
}

void Tim2::book_compare() {
  const std::uint64_t generation = ++generation_;
  if ((interrupts_ & 2) == 0 || (control_ & 1) == 0) return;
  const auto ahead = static_cast<std::uint32_t>(compare_ - static_cast<std::uint32_t>(count()));
  const Time unit = kSecond / (around_.sysclk_hz() / (prescaler_ + 1));
  const Time phase = (around_.time().now() - base_) % unit;
  const Time wait = (ahead == 0 ? Time{1} << 32 : Time{ahead}) * unit - phase;
  around_.time().after(wait, [this, generation] {
    if (generation != generation_) return;
    status_ |= 2;
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
      return compare_;
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
      if ((value & 2) != 0) status_ |= 2;
      break;
    case 0x28:
      prescaler_next_ = value & 0xFFFF;
      break;
    case 0x2C:
      if (value != 0xFFFFFFFF) around_.violation("TIM2_ARR: only the full period is modelled");
      break;
    case 0x34:
      compare_ = value;
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
  const std::uint64_t generation = ++generation_;
  const Time unit = kSecond / 32'000 * (Time{4} << prescaler_);
  around_.time().after(unit * (reload_ + 1), [this, generation] {
    if (generation == generation_) around_.request_reset(1U << 29);
  });
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

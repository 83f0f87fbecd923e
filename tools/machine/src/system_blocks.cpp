// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/machine/system_blocks.hpp"

#include <fmt/format.h>

namespace triskin::machine {
namespace {

constexpr Time kCrystalStart = 2000 * kMicrosecond, kPllStart = 40 * kMicrosecond, kHsi48Start = 6 * kMicrosecond;
constexpr std::uint32_t kCr = 0x00, kCfgr = 0x08, kCifr = 0x1C, kCicr = 0x20, kPllCfgr = 0x0C, kCsr = 0x94,
                        kCrrcr = 0x98;
constexpr std::uint64_t kHsi_hz = 16'000'000;
// The limits are from DS12288, PLL characteristics.
constexpr std::uint64_t kMinPllInput_hz = 2'660'000, kMaxPllInput_hz = 16'000'000, kMinVco_hz = 96'000'000,
                        kMaxVco_hz = 344'000'000;

}  // namespace

void Rcc::reset() {
  ++generation_;
  regs_ = {};
  regs_[kCr / 4] = 0x500;  // HSI is on and ready.
  regs_[kCfgr / 4] = 5;
  regs_[kPllCfgr / 4] = 0x1000;
  regs_[map::kAhb1 / 4] = 1U << map::kFlashBit;
  regs_[map::kApb1 / 4] = 0x400;  // The bit enables the bus clock of the RTC.
  sysclk_hz_ = kHsi_hz;
  wait_states_ = 0;
  boost_ = stopped_ = false;
}

std::uint64_t Rcc::crystal_hz() const {
  const bool ready = (regs_[kCr / 4] >> 17 & 1) != 0;
  return ready && around_.time().now() < crystal_.fails_at ? crystal_.hz : 0;
}

// The divisors alone decide the frequency of the PLL's oscillator; outside its limits it may not lock.
void Rcc::start_pll(std::uint32_t before) {
  const std::uint32_t cr = regs_[kCr / 4], pll = regs_[kPllCfgr / 4];
  if ((cr >> 24 & 1) == 0 || (before >> 24 & 1) != 0) return;
  const std::uint64_t source = (pll & 3) == 3 ? crystal_hz() : (pll & 3) == 2 ? kHsi_hz : 0;
  if (source == 0) return around_.violation("PLL started without a clock at its input");
  const std::uint64_t input = source / ((pll >> 4 & 15) + 1), vco = input * (pll >> 8 & 127);
  if (input < kMinPllInput_hz || input > kMaxPllInput_hz)
    return around_.violation(fmt::format("PLL input of {} Hz: 2.66 … 16 MHz", input));
  if (vco < kMinVco_hz || vco > kMaxVco_hz)
    return around_.violation(fmt::format("PLL oscillator at {} Hz: 96 … 344 MHz", vco));
  around_.time().after(kPllStart, [this, g = generation_] {
    if (g == generation_ && (regs_[kCr / 4] >> 24 & 1) != 0) regs_[kCr / 4] |= 1U << 25;
  });
}

void Rcc::lose_crystal() {
  std::uint32_t& cr = regs_[kCr / 4];
  cr &= ~(1U << 17);
  const bool feeds_pll = (regs_[kPllCfgr / 4] & 3) == 3,
             used = (regs_[kCfgr / 4] >> 2 & 3) == 2 || ((regs_[kCfgr / 4] >> 2 & 3) == 3 && feeds_pll);
  if (!used) return;
  if ((cr >> 19 & 1) == 0) {
    stopped_ = true;
    return;
  }
  cr &= ~(1U << 16 | 1U << 24 | 1U << 25);
  regs_[kCfgr / 4] = (regs_[kCfgr / 4] & ~0xFU) | 5;
  sysclk_hz_ = kHsi_hz;
  regs_[kCifr / 4] |= 1U << 8;
  around_.raise_nmi();
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
  if (crystal_.hz != 0 && around_.time().now() < crystal_.fails_at) start(16, 17, kCrystalStart);
  if ((cr >> 24 & 1) == 0) cr &= ~(1U << 25);
  start_pll(before);
  const bool starts = (cr >> 16 & 1) != 0 && (before >> 16 & 1) == 0;
  if (!starts || crystal_.fails_at == kNever || around_.time().now() >= crystal_.fails_at) return;
  around_.time().after(crystal_.fails_at - around_.time().now(), [this, g = generation_] {
    if (g == generation_) lose_crystal();
  });
}

// Computes the clock and checks the rules for a high frequency: wait states, boost, AHB halved in between.
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
  std::uint64_t hz = wanted == 1 ? kHsi_hz : crystal_.hz;
  if (wanted == 3) {
    const std::uint32_t pll = regs_[kPllCfgr / 4];
    hz = (pll & 3) == 3 ? crystal_.hz : kHsi_hz;
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
    case kCicr:
      regs_[kCifr / 4] &= ~value;
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
  return (around_.time().now() - base_) / (kSecond / hz);
}

void Tim2::book_compare() {
  ++generation_;
  if ((control_ & 1) == 0) return;
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

// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "triskin/machine/map_l452.hpp"
#include "triskin/machine/system_blocks.hpp"

namespace triskin::machine {
namespace {

constexpr Time kCrystalStart = 2000 * kMicrosecond, kPllStart = 40 * kMicrosecond, kHsi48Start = 6 * kMicrosecond,
               kHsiStart = 4 * kMicrosecond;
constexpr std::uint32_t kCr = 0x00, kCfgr = 0x08, kCifr = 0x1C, kCicr = 0x20, kPllCfgr = 0x0C, kCsr = 0x94,
                        kCrrcr = 0x98;
constexpr std::uint32_t kHsiReady = 10, kHseOn = 16, kHseReady = 17, kSecurity = 19, kPllOn = 24, kPllReady = 25;
constexpr std::uint64_t kHsi_hz = 16'000'000, kMsi_hz = 4'000'000;

}  // namespace

void ClockControl::reset_clocks(std::uint32_t control, std::uint64_t hz) {
  ++generation_;
  regs_ = {};
  reg(kCr) = control;
  sysclk_hz_ = hz;
  wait_states_ = 0;
  boost_ = stopped_ = false;
}

std::uint64_t ClockControl::internal_hz() const {
  return static_cast<std::uint64_t>(static_cast<double>(kHsi_hz) * (1 + crystal_.internal_error));
}

std::uint64_t ClockControl::crystal_hz() const {
  const bool ready = (reg(kCr) >> kHseReady & 1) != 0;
  return ready && around_.time().now() < crystal_.fails_at ? crystal_.hz : 0;
}

void ClockControl::start_oscillator(std::uint32_t before, unsigned on, unsigned ready, Time delay) {
  if ((reg(kCr) >> on & 1) == 0) {
    reg(kCr) &= ~(1U << ready);
  } else if ((before >> on & 1) == 0) {
    around_.time().after(delay, [this, ready, g = generation_] {
      if (g == generation_) reg(kCr) |= 1U << ready;
    });
  }
}

// The divisors alone decide the frequency of the PLL's oscillator; outside its limits it may not lock.
void ClockControl::start_pll(std::uint32_t before) {
  if ((reg(kCr) >> kPllOn & 1) == 0 || (before >> kPllOn & 1) != 0) return;
  const std::uint32_t setting = reg(kPllCfgr);
  const std::uint64_t source = pll_source_hz(setting & 3);
  if (source == 0) return around_.violation("PLL started without a clock at its input");
  const Pll& limits = pll();
  const std::uint64_t input = source / ((setting >> 4 & limits.divider_mask) + 1), vco = input * (setting >> 8 & 127);
  if (input < limits.min_input_hz || input > limits.max_input_hz)
    return around_.violation(fmt::format("PLL input of {} Hz: {}", input, limits.input));
  if (vco < limits.min_vco_hz || vco > limits.max_vco_hz)
    return around_.violation(fmt::format("PLL oscillator at {} Hz: {}", vco, limits.oscillator));
  around_.time().after(kPllStart, [this, g = generation_] {
    if (g == generation_ && (reg(kCr) >> kPllOn & 1) != 0) reg(kCr) |= 1U << kPllReady;
  });
}

void ClockControl::lose_crystal() {
  std::uint32_t& cr = reg(kCr);
  cr &= ~(1U << kHseReady);
  const std::uint32_t used = reg(kCfgr) >> 2 & 3;
  const bool feeds_core = used == 2 || (used == 3 && (reg(kPllCfgr) & 3) == 3);
  if (!feeds_core) return;
  if ((cr >> kSecurity & 1) == 0) {
    stopped_ = true;
    return;
  }
  cr &= ~(1U << kHseOn | 1U << kPllOn | 1U << kPllReady);
  use_internal();
  reg(kCifr) |= 1U << 8;
  around_.raise_nmi();
}

std::uint32_t ClockControl::read(std::uint32_t offset, unsigned) {
  return offset == kCsr ? csr_flags_ : reg(offset);
}

void ClockControl::write_control(std::uint32_t value) {
  constexpr std::uint32_t kReadOnly = 1U << 1 | 1U << kHsiReady | 1U << kHseReady | 1U << kPllReady;
  std::uint32_t& cr = reg(kCr);
  const std::uint32_t before = cr;
  cr = (value & ~kReadOnly) | (before & kReadOnly);
  const bool works = crystal_.hz != 0 && around_.time().now() < crystal_.fails_at;
  if (works) start_oscillator(before, kHseOn, kHseReady, kCrystalStart);
  write_oscillators(before);
  if ((cr >> kPllOn & 1) == 0) cr &= ~(1U << kPllReady);
  start_pll(before);
  const bool starts = (cr >> kHseOn & 1) != 0 && (before >> kHseOn & 1) == 0;
  if (!starts || crystal_.fails_at == kNever || around_.time().now() >= crystal_.fails_at) return;
  around_.time().after(crystal_.fails_at - around_.time().now(), [this, g = generation_] {
    if (g == generation_) lose_crystal();
  });
}

void ClockControl::switch_clock() {
  std::uint32_t& cfgr = reg(kCfgr);
  const std::uint32_t wanted = cfgr & 3;
  const bool ready = wanted == 3 ? (reg(kCr) >> kPllReady & 1) != 0 : source_hz(wanted) != 0;
  if (!ready) {
    around_.violation("RCC_CFGR.SW names a clock that is not ready");
    return;
  }
  const bool was_pll = (cfgr >> 2 & 3) == 3;
  cfgr = (cfgr & ~0xCU) | wanted << 2;
  std::uint64_t hz = wanted == 3 ? 0 : source_hz(wanted);
  if (wanted == 3) {
    const std::uint32_t setting = reg(kPllCfgr);
    hz = (setting & 3) == 3 ? crystal_.hz : pll_source_hz(setting & 3);
    hz = hz / ((setting >> 4 & pll().divider_mask) + 1) * (setting >> 8 & 127) / (2 * ((setting >> 25 & 3) + 1));
    if ((setting >> 24 & 1) == 0) around_.violation("RCC_PLLCFGR.PLLREN is off: the PLL has no output");
    check_clock(hz, was_pll);
  }
  sysclk_hz_ = (cfgr & 0xF0) == 0x80 ? hz / 2 : hz;
}

void ClockControl::write(std::uint32_t offset, std::uint32_t value, unsigned) {
  switch (offset) {
    case kCr:
      write_control(value);
      return;
    case kCfgr:
      reg(kCfgr) = (value & ~0xCU) | (reg(kCfgr) & 0xCU);
      switch_clock();
      return;
    case kPllCfgr:
      if ((reg(kCr) >> kPllOn & 1) != 0)
        around_.violation("RCC_PLLCFGR written while the PLL runs");
      else
        reg(kPllCfgr) = value;
      return;
    case kCicr:
      reg(kCifr) &= ~value;
      return;
    case kCsr:
      if ((value >> 23 & 1) != 0) csr_flags_ = 0;
      return;
    case kCrrcr:
      reg(kCrrcr) = (value & 1) == 0 ? 0 : (reg(kCrrcr) & 2) | 1;
      if ((value & 1) == 0) return;
      around_.time().after(kHsi48Start, [this, g = generation_] {
        if (g == generation_ && (reg(kCrrcr) & 1) != 0) reg(kCrrcr) |= 2;
      });
      return;
    default:
      reg(offset) = value;
  }
}

void Rcc::reset() {
  reset_clocks(0x500, internal_hz());  // HSI is on and ready.
  reg(kCfgr) = 5;
  reg(kPllCfgr) = 0x1000;
  reg(map::kAhb1) = 1U << map::kFlashBit;
  reg(map::kApb1) = 0x400;  // The bit enables the bus clock of the RTC.
}

// The limits are from DS12288, PLL characteristics.
const ClockControl::Pll& Rcc::pll() const {
  static constexpr Pll kPll{2'660'000, 16'000'000, 96'000'000, 344'000'000, "2.66 … 16 MHz", "96 … 344 MHz", 15};
  return kPll;
}

std::uint64_t Rcc::source_hz(std::uint32_t source) const {
  return source == 1 ? internal_hz() : source == 2 ? crystal_hz() : 0;
}

std::uint64_t Rcc::pll_source_hz(std::uint32_t source) const {
  return source == 3 ? crystal_hz() : source == 2 ? internal_hz() : 0;
}

void Rcc::use_internal() {
  reg(kCfgr) = (reg(kCfgr) & ~0xFU) | 5;
  set_sysclk(internal_hz());
}

// A high frequency needs wait states, boost, and the AHB clock halved in between.
void Rcc::check_clock(std::uint64_t hz, bool was_pll) {
  if (hz > 170'000'000) around_.violation(fmt::format("SYSCLK of {} Hz", hz));
  if (!was_pll && hz > 80'000'000 && (reg(kCfgr) & 0xF0) == 0)
    around_.violation("switched above 80 MHz without halving the AHB clock");
  if (hz > 150'000'000 && !boost()) around_.violation("above 150 MHz without PWR_CR5 boost");
  if (hz > (wait_states() + 1) * 34'000'000ULL)
    around_.violation(fmt::format("{} flash wait states at {} Hz", wait_states(), hz));
}

void RccL4::reset() {
  reset_clocks(map::l452::kRccCrReset, kMsi_hz);  // MSI is on and ready, in range 6.
  reg(kPllCfgr) = 0x1000;
  reg(map::kAhb1) = 1U << map::kFlashBit;
}

// The limits are from DS11912, PLL characteristics.
const ClockControl::Pll& RccL4::pll() const {
  static constexpr Pll kPll{4'000'000, 16'000'000, 64'000'000, 344'000'000, "4 … 16 MHz", "64 … 344 MHz", 7};
  return kPll;
}

std::uint64_t RccL4::source_hz(std::uint32_t source) const {
  const bool hsi = (reg(kCr) >> kHsiReady & 1) != 0;
  return source == 0 ? kMsi_hz : source == 1 ? (hsi ? internal_hz() : 0) : source == 2 ? crystal_hz() : 0;
}

std::uint64_t RccL4::pll_source_hz(std::uint32_t source) const {
  return source == 0 ? 0 : source_hz(source - 1);
}

// CFGR.STOPWUCK = 0 selects MSI.
void RccL4::use_internal() {
  reg(kCfgr) &= ~0xFU;
  set_sysclk(kMsi_hz);
}

void RccL4::write_oscillators(std::uint32_t before) {
  start_oscillator(before, 8, kHsiReady, kHsiStart);
  if (((reg(kCr) ^ before) & 0xF8) != 0) around_.violation("RCC_CR: only the range of MSI after a reset is modelled");
}

void RccL4::check_clock(std::uint64_t hz, bool) {
  if (hz > 80'000'000) around_.violation(fmt::format("SYSCLK of {} Hz", hz));
  if (hz > (wait_states() + 1) * 16'000'000ULL)
    around_.violation(fmt::format("{} flash wait states at {} Hz", wait_states(), hz));
}

}  // namespace triskin::machine

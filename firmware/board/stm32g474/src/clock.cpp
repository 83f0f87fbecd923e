// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>

#include "pll.hpp"
#include "triskin/board/board.hpp"
#include "triskin/board/clock_plan.hpp"
#include "triskin/board/registers/system.hpp"
#include "triskin/board/registers/timer16.hpp"
#include "triskin/board/survivor.hpp"

namespace triskin::board {
namespace {

// These limits count polls of about five cycles at 16 MHz. A clock that does not start must not keep the loader from a
// host that could help.
constexpr std::uint32_t kCrystalLooks = 200'000;  // The limit is 60 ms; crystals start within 10 ms.
constexpr std::uint32_t kPllLooks = 10'000;       // The limit is 3 ms; the PLL locks within 40 µs (DS12288).
// The limit is 300 µs; eight periods of the slowest crystal by 32 are 64 µs.
constexpr std::uint32_t kCaptureLooks = 1'000;

void raise_core_voltage() {
  rcc_reg::kApb1Enr1.set(rcc_reg::kPwr);
  (void)rcc_reg::kApb1Enr1.read();  // The clock needs two cycles (§7.2.16).
  pwr_reg::kCr5.clear(pwr_reg::kNoBoost);
}

bool start_crystal() {
  rcc_reg::kCr.set(rcc_reg::kHseOn);
  return wait_for(rcc_reg::kCr, rcc_reg::kHseReady, kCrystalLooks);
}

// Returns the count at the next captured edge, every eighth of the crystal by 32; empty if none came or one was missed.
std::optional<std::uint16_t> next_edge() {
  using namespace tim16_reg;
  if (!wait_for(kSr, kCaptured, kCaptureLooks)) return std::nullopt;
  const auto count = static_cast<std::uint16_t>(kCcr1.read());  // Reading clears the flag.
  if (kSr.any(kOvercaptured)) return std::nullopt;
  return count;
}

// Here the core and TIM16 run from the internal oscillator of 16 MHz. 256 periods of the crystal by 32 are counted: 2
// ms with 4 MHz, which fits into the sixteen bits of the counter, and 5,243 counts with 25 MHz.
std::optional<std::uint32_t> measure_crystal_hz() {
  using namespace tim16_reg;
  constexpr std::uint32_t kCaptures = 32, kCycles = kCaptures * 8 * 32;
  rcc_reg::kApb2Enr.set(rcc_reg::kTim16);
  (void)rcc_reg::kApb2Enr.read();
  kTisel.write(kCrystalBy32);
  kCcmr1.write(kCaptureFromInput | kEachEighthEdge);
  kCcer.write(kCaptureOn);
  kCr1.write(kEnable);
  kSr.write(0);       // Earlier edges are cleared here.
  (void)next_edge();  // The first edge may be older than the interval that is counted.
  const auto first = next_edge();
  auto last = first;
  for (std::uint32_t k = 0; k < kCaptures && last; ++k) last = next_edge();
  kCr1.write(0);
  rcc_reg::kApb2Enr.clear(rcc_reg::kTim16);
  if (!first || !last) return std::nullopt;
  const auto counts = static_cast<std::uint16_t>(*last - *first);
  constexpr std::uint64_t kInternal_hz = 16'000'000;
  return counts == 0 ? std::nullopt : std::optional(static_cast<std::uint32_t>(kCycles * kInternal_hz / counts));
}

// Uses the crystal if it works; otherwise the result has the reason.
wire::ClockState choose_pll() {
  constexpr PllSetting kInternal = pll_setting(16'000'000).value();
  wire::ClockState state;
  if (!start_crystal()) {
    state.crystal = wire::Crystal::kSilent;
  } else if (const auto measured = measure_crystal_hz(); !measured) {
    state.crystal = wire::Crystal::kNotMeasured;
  } else {
    state.measured_khz = static_cast<std::uint16_t>(std::min<std::uint32_t>(*measured / 1000, 0xFFFF));
    const auto crystal_hz = crystal_near(*measured);
    state.crystal = crystal_hz ? wire::Crystal::kUsed : wire::Crystal::kUnknown;
    if (crystal_hz && start_pll(rcc_reg::kPllFromHse, *pll_setting(*crystal_hz), kPllLooks)) {
      state.crystal_mhz = static_cast<std::uint8_t>(*crystal_hz / 1'000'000);
      rcc_reg::kCr.set(rcc_reg::kClockSecurity);  // A crystal that stops then causes an NMI instead of silence.
      return state;
    }
    if (crystal_hz) state.crystal = wire::Crystal::kNoLock;
  }
  rcc_reg::kCr.clear(rcc_reg::kHseOn);
  if (!start_pll(rcc_reg::kPllFromHsi, kInternal, kPllLooks)) state.crystal = wire::Crystal::kNoPll;
  return state;
}

void switch_to_pll() {
  // The other bits stay: without DBG_SWEN (1 at reset) a debugger is locked out (§3.7.1).
  flash_reg::kAcr.modify(flash_reg::kLatencyMask, flash_reg::kLatency4 | flash_reg::kPrefetch |
                                                      flash_reg::kInstructionCache | flash_reg::kDataCache);
  while ((flash_reg::kAcr.read() & flash_reg::kLatencyMask) != flash_reg::kLatency4) {
  }
  // Above 80 MHz the AHB clock is halved for at least 1 µs while switching (§7.2.7).
  rcc_reg::kCfgr.modify(rcc_reg::kAhbMask, rcc_reg::kAhbHalf);
  rcc_reg::kCfgr.modify(rcc_reg::kSwitchMask, rcc_reg::kSwitchPll);
  while ((rcc_reg::kCfgr.read() >> rcc_reg::kStatusShift & 3U) != rcc_reg::kSwitchPll) {
  }
  for (int k = 0; k < 100; ++k) asm volatile("nop");
  rcc_reg::kCfgr.clear(rcc_reg::kAhbMask);
}

}  // namespace

void start_clocks() {
  // The loader has already switched to the PLL. It jumps with the prefetch off.
  if ((rcc_reg::kCfgr.read() >> rcc_reg::kStatusShift & 3U) == rcc_reg::kSwitchPll)
    return flash_reg::kAcr.set(flash_reg::kPrefetch);
  raise_core_voltage();
  survivor().clock = choose_pll();
  if (survivor().clock.crystal == wire::Crystal::kNoPll) fail(wire::CrashCause::kClock);
  switch_to_pll();
}

}  // namespace triskin::board

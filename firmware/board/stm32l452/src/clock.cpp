// SPDX-License-Identifier: Apache-2.0
#include "pll.hpp"
#include "triskin/board/board.hpp"
#include "triskin/board/board_config.hpp"
#include "triskin/board/clock_plan.hpp"
#include "triskin/board/registers/system.hpp"
#include "triskin/board/survivor.hpp"

namespace triskin::board {
namespace {

// These limits count polls of about five cycles at the 4 MHz of MSI, which the core has after a reset. A clock that
// does not start must not keep the loader from a host that could help.
constexpr std::uint32_t kCrystalLooks = 50'000;  // The limit is 60 ms; crystals start within 10 ms.
constexpr std::uint32_t kInternalLooks = 1'000;  // The limit is 1 ms; HSI starts within 4 µs (DS11912).
constexpr std::uint32_t kPllLooks = 2'500;       // The limit is 3 ms; the PLL locks within 40 µs (DS11912).

bool start_crystal() {
  if constexpr (config::kClockInput) rcc_reg::kCr.set(rcc_reg::kHseBypass);
  rcc_reg::kCr.set(rcc_reg::kHseOn);
  return wait_for(rcc_reg::kCr, rcc_reg::kHseReady, kCrystalLooks);
}

// Tries the crystal that the header of the board states. Returns the reason if its clock cannot be used.
wire::Crystal use_crystal() {
  constexpr auto kSetting = pll_setting(config::kCrystal_mhz * 1'000'000);
  static_assert(config::kCrystal_mhz == 0 || kSetting.has_value(), "the PLL cannot make 80 MHz of this crystal");
  if (!kSetting || !start_crystal()) return wire::Crystal::kSilent;
  if (!start_pll(rcc_reg::kPllFromHse, *kSetting, kPllLooks)) return wire::Crystal::kNoLock;
  rcc_reg::kCr.set(rcc_reg::kClockSecurity);  // A crystal that stops then causes an NMI instead of silence.
  return wire::Crystal::kUsed;
}

wire::ClockState choose_pll() {
  constexpr PllSetting kInternal = pll_setting(16'000'000).value();
  wire::ClockState state;
  rcc_reg::kCr.set(rcc_reg::kHsiOn);
  const bool internal = wait_for(rcc_reg::kCr, rcc_reg::kHsiReady, kInternalLooks);
  state.crystal = use_crystal();
  if (state.crystal == wire::Crystal::kUsed) {
    state.crystal_mhz = config::kCrystal_mhz;
    return state;
  }
  rcc_reg::kCr.clear(rcc_reg::kHseOn);
  if (!internal || !start_pll(rcc_reg::kPllFromHsi, kInternal, kPllLooks)) state.crystal = wire::Crystal::kNoPll;
  return state;
}

// Voltage range 1, which 80 MHz need, is on after a reset.
void switch_to_pll() {
  flash_reg::kAcr.modify(flash_reg::kLatencyMask, flash_reg::kLatency4 | flash_reg::kPrefetch |
                                                      flash_reg::kInstructionCache | flash_reg::kDataCache);
  while ((flash_reg::kAcr.read() & flash_reg::kLatencyMask) != flash_reg::kLatency4) {
  }
  rcc_reg::kCfgr.modify(rcc_reg::kSwitchMask, rcc_reg::kSwitchPll);
  while ((rcc_reg::kCfgr.read() >> rcc_reg::kStatusShift & rcc_reg::kSwitchMask) != rcc_reg::kSwitchPll) {
  }
}

}  // namespace

void start_clocks() {
  // The loader has already switched to the PLL. It jumps with the prefetch off.
  if ((rcc_reg::kCfgr.read() >> rcc_reg::kStatusShift & rcc_reg::kSwitchMask) == rcc_reg::kSwitchPll)
    return flash_reg::kAcr.set(flash_reg::kPrefetch);
  survivor().clock = choose_pll();
  if (survivor().clock.crystal == wire::Crystal::kNoPll) fail(wire::CrashCause::kClock);
  switch_to_pll();
}

}  // namespace triskin::board

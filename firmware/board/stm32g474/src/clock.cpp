// SPDX-License-Identifier: Apache-2.0
#include "triskin/board/board.hpp"
#include "triskin/board/priorities.hpp"
#include "triskin/board/registers/system.hpp"

extern "C" void tim2_handler();

namespace triskin::board {
namespace {

constexpr std::uint32_t kHseWaitLoops = 200'000;  // crystals start within 10 ms

void raise_core_voltage() {
  rcc_reg::kApb1Enr1.set(rcc_reg::kPwr);
  (void)rcc_reg::kApb1Enr1.read();  // the clock needs two cycles (§7.2.16)
  pwr_reg::kCr5.clear(pwr_reg::kNoBoost);
}

bool start_crystal() {
  rcc_reg::kCr.set(rcc_reg::kHseOn);
  for (std::uint32_t k = 0; k < kHseWaitLoops; ++k) {
    if (rcc_reg::kCr.any(rcc_reg::kHseReady)) return true;
  }
  return false;
}

// Crystal or 16 MHz oscillator, divided to 4 MHz, · 85 / 2 = 170 MHz (R = 2 is 0 in bits 25–26).
static_assert(TRISKIN_CRYSTAL_MHZ % 4 == 0 && TRISKIN_CRYSTAL_MHZ >= 4 && TRISKIN_CRYSTAL_MHZ <= 48);
constexpr std::uint32_t kPllCommon = 85U << rcc_reg::kPllNShift | rcc_reg::kPllREnable;
constexpr std::uint32_t kPllCrystal =
    rcc_reg::kPllFromHse | (TRISKIN_CRYSTAL_MHZ / 4 - 1U) << rcc_reg::kPllMShift | kPllCommon;
constexpr std::uint32_t kPllInternal = rcc_reg::kPllFromHsi | (4U - 1U) << rcc_reg::kPllMShift | kPllCommon;

}  // namespace

void start_clocks() {
  if ((rcc_reg::kCfgr.read() >> rcc_reg::kStatusShift & 3U) == rcc_reg::kSwitchPll) return;  // the loader did it
  raise_core_voltage();
  rcc_reg::kPllCfgr.write(start_crystal() ? kPllCrystal : kPllInternal);
  rcc_reg::kCr.set(rcc_reg::kPllOn);
  while (!rcc_reg::kCr.any(rcc_reg::kPllReady)) {
  }
  // The other bits stay: without DBG_SWEN (1 at reset) a debugger is shut out (§3.7.1).
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

namespace {
std::uint32_t last_count = 0;
std::uint32_t wraps = 0;
}  // namespace

void start_microseconds() {
  rcc_reg::kApb1Enr1.set(rcc_reg::kTim2);
  (void)rcc_reg::kApb1Enr1.read();
  tim2_reg::kPsc.write(170 - 1);
  tim2_reg::kArr.write(0xFFFFFFFF);
  tim2_reg::kEgr.write(tim2_reg::kUpdate);  // loads the prescaler
  tim2_reg::kSr.write(0);
  tim2_reg::kCr1.write(tim2_reg::kEnable);
  core_reg::set_priority(tim2_reg::kIrq, priority::kTimer);
  core_reg::enable_interrupt(tim2_reg::kIrq);
}

std::uint64_t microseconds() {
  const InterruptLock lock;
  const std::uint32_t count = tim2_reg::kCnt.read();
  if (count < last_count) ++wraps;
  last_count = count;
  return static_cast<std::uint64_t>(wraps) << 32 | count;
}

void wake_at(std::uint64_t at_us) {
  tim2_reg::kCcr1.write(static_cast<std::uint32_t>(at_us));
  tim2_reg::kSr.write(~tim2_reg::kCompare1);
  tim2_reg::kDier.write(tim2_reg::kCompare1);
  // A time that has just passed would be missed for a whole turn of the counter.
  if (microseconds() >= at_us) tim2_reg::kEgr.write(tim2_reg::kCompare1);
}

void start_watchdog() {
  iwdg_reg::kKr.write(iwdg_reg::kStart);
  iwdg_reg::kKr.write(iwdg_reg::kUnlock);
  iwdg_reg::kPr.write(iwdg_reg::kPrescaler32);
  iwdg_reg::kRlr.write(2000);
  while (iwdg_reg::kSr.read() != 0) {
  }
  iwdg_reg::kKr.write(iwdg_reg::kReload);
}

void feed_watchdog() {
  iwdg_reg::kKr.write(iwdg_reg::kReload);
}

wire::UniqueId unique_id() {
  wire::UniqueId id{};
  for (std::uint32_t k = 0; k < id.size(); ++k) {
    const std::uint32_t word = Register(kUniqueIdAddress + (k & ~3U)).read();
    id[k] = static_cast<std::uint8_t>(word >> (8 * (k % 4)));
  }
  return id;
}

}  // namespace triskin::board

extern "C" void tim2_handler() {
  using namespace triskin::board;
  tim2_reg::kSr.write(0);
  tim2_reg::kDier.write(0);
  asm volatile("dsb" ::: "memory");  // a store may not overlap the return (Cortex-M4 erratum 838869)
}

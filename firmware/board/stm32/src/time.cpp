// SPDX-License-Identifier: Apache-2.0
// Time, watchdog and the chip's id.
#include "crash.hpp"
#include "triskin/board/board.hpp"
#include "triskin/board/clock_plan.hpp"
#include "triskin/board/priorities.hpp"
#include "triskin/board/registers/system.hpp"

extern "C" {
void tim2_handler();
void serve_timer(const std::uint32_t* frame);
}

namespace triskin::board {
namespace {
std::uint32_t last_count = 0;
std::uint32_t wraps = 0;
bool counting = false;
}  // namespace

void start_microseconds() {
  rcc_reg::kApb1Enr1.set(rcc_reg::kTim2);
  (void)rcc_reg::kApb1Enr1.read();
  tim2_reg::kPsc.write(kSysclk_hz / 1'000'000 - 1);
  tim2_reg::kArr.write(0xFFFFFFFF);
  tim2_reg::kEgr.write(tim2_reg::kUpdate);  // An update event loads the prescaler.
  tim2_reg::kSr.write(0);
  tim2_reg::kCr1.write(tim2_reg::kEnable);
  counting = true;
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
  const InterruptLock lock;  // The interrupt handler changes the same registers.
  tim2_reg::kCcr1.write(static_cast<std::uint32_t>(at_us));
  tim2_reg::kSr.write(~tim2_reg::kCompare1);
  tim2_reg::kDier.set(tim2_reg::kCompare1);
  // A time that has just passed would be missed for a whole turn of the counter.
  if (microseconds() >= at_us) tim2_reg::kEgr.write(tim2_reg::kCompare1);
}

void start_watchdog() {
  // Not every debugger does this itself. TIM2 gives the warning before the watchdog.
  debug_reg::kApb1Freeze.set(debug_reg::kTim2Stands | debug_reg::kWatchdogStands);
  iwdg_reg::kKr.write(iwdg_reg::kStart);
  iwdg_reg::kKr.write(iwdg_reg::kUnlock);
  iwdg_reg::kPr.write(iwdg_reg::kPrescaler32);
  iwdg_reg::kRlr.write(2000);
  while (iwdg_reg::kSr.read() != 0) {
  }
  iwdg_reg::kKr.write(iwdg_reg::kReload);
}

// The watchdog's oscillator may be as fast as 34 kHz (DS12288); it then resets after 1.88 s.
void feed_watchdog() {
  constexpr std::uint32_t kWarning_us = 1'700'000;
  iwdg_reg::kKr.write(iwdg_reg::kReload);
  if (!counting) return;
  const InterruptLock lock;
  tim2_reg::kCcr2.write(tim2_reg::kCnt.read() + kWarning_us);
  tim2_reg::kSr.write(~tim2_reg::kCompare2);
  tim2_reg::kDier.set(tim2_reg::kCompare2);
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

// The frame of the exception says where the program was.
extern "C" [[gnu::naked]] void tim2_handler() {
  asm volatile("mov r0, sp\n b serve_timer");
}

extern "C" void serve_timer(const std::uint32_t* frame) {
  using namespace triskin::board;
  if ((tim2_reg::kSr.read() & tim2_reg::kDier.read() & tim2_reg::kCompare2) != 0) note_hang(frame);
  // wake_at() may have set another time while this interrupt was pending; then its flag is clear, and that time remains
  // set.
  if (tim2_reg::kSr.any(tim2_reg::kCompare1)) {
    tim2_reg::kSr.write(~tim2_reg::kCompare1);
    tim2_reg::kDier.clear(tim2_reg::kCompare1);
  }
  asm volatile("dsb" ::: "memory");  // A store may not overlap the return (Cortex-M4 erratum 838869).
}

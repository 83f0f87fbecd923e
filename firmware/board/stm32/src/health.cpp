// SPDX-License-Identifier: Apache-2.0
#include "health.hpp"

#include <algorithm>

#include "can.hpp"
#include "triskin/board/board.hpp"
#include "triskin/board/budget.hpp"
#include "triskin/board/registers/system.hpp"
#include "triskin/board/survivor.hpp"

extern "C" std::uint32_t triskin_stack_bottom, triskin_stack_top;

namespace triskin::board {
namespace {

constexpr std::uint32_t kStackPaint = 0x5AFE5AFE;

std::uint8_t cause_of(std::uint32_t flags) {
  using namespace wire::reset_cause;
  const auto bit_if = [flags](std::uint32_t flag, std::uint8_t bit) { return (flags & flag) != 0 ? bit : 0; };
  const int others = bit_if(rcc_reg::kPowerReset, kPower) | bit_if(rcc_reg::kSoftwareReset, kSoftware) |
                     bit_if(rcc_reg::kWatchdogReset, kWatchdog) | bit_if(rcc_reg::kOptionReset, kOptions);
  // Every reset of the chip also pulls the pin low and sets its flag (§7.1.2), so the pin is the cause only if it is
  // alone.
  return static_cast<std::uint8_t>(others != 0 ? others : bit_if(rcc_reg::kPinReset, kPin));
}

// A corrected unit raises no interrupt, so the flag is read when the health is requested.
void count_corrected_units() {
  constexpr std::uint32_t kCorrected = flash_reg::kEccCorrected | flash_reg::kEccCorrectedHigh;
  const std::uint32_t flags = flash_reg::kEccr.read() & kCorrected;
  if (flags == 0) return;
  flash_reg::kEccr.write(flags);
  ++triskin_budget.ecc_corrected;
}

}  // namespace

Stm32Monitor monitor;

void measure_stack() {
  const std::uint32_t* p = &triskin_stack_bottom;
  while (p < &triskin_stack_top && *p == kStackPaint) ++p;
  triskin_budget.stack_free_bytes = static_cast<std::uint32_t>(p - &triskin_stack_bottom) * 4;
}

wire::BoardHealth Stm32Monitor::health() const {
  measure_stack();
  count_corrected_units();
  const Budget& b = triskin_budget;
  wire::BoardHealth h;
  h.clock = survivor().clock;
  h.reset_cause = cause_of(b.reset_cause);
  h.findings = static_cast<std::uint16_t>(b.findings);
  h.crashes_in_row = static_cast<std::uint8_t>(std::min<std::uint32_t>(survivor().crashes_in_row, 255));
  can.describe(h);
  h.ecc_corrected = b.ecc_corrected;
  h.ecc_detected = b.ecc_faults;
  h.flash_errors = b.flash_errors;
  h.worst_loop_us = b.worst_loop_us;
  h.worst_interrupt_us = b.worst_interrupt_us;
  h.stack_bytes = static_cast<std::uint16_t>((&triskin_stack_top - &triskin_stack_bottom) * 4);
  h.stack_free_bytes = static_cast<std::uint16_t>(b.stack_free_bytes);
  h.idle_permille = static_cast<std::uint16_t>(b.idle_us * 1000 / std::max<std::uint64_t>(microseconds(), 1));
  return h;
}

std::optional<wire::Crash> Stm32Monitor::crash() const {
  const wire::Crash& c = survivor().crash;
  return c.cause == wire::CrashCause::kNone ? std::nullopt : std::optional(c);
}

// A power failure while options are written may leave the chip read protected, so the supply must have been stable for
// a while.
bool Stm32Monitor::protect_loader(bool on) {
  constexpr std::uint64_t kSupplyStands_us = 2'000'000;
  return microseconds() > kSupplyStands_us && board::protect_loader(on);
}

void Stm32Monitor::forget_crash() {
  survivor().crash = {};
}

}  // namespace triskin::board

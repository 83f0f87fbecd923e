// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/wire/unique_id.hpp"

/// The loader and the application share these low-level parts.
namespace triskin::board {

/// Runs the PLL from the crystal, so that the core and the buses have the clock of `clock_plan.hpp` (STM32G474: RM0440
/// §6.1.5, §7.2.4, §3.3.3). If the crystal is missing, unknown or fails, it uses the internal oscillator, whose
/// ± 1 % suffice for I²C and, as a rule, for classic CAN.
/// survivor().clock then says what was chosen and why. Takes at most 70 ms; does nothing when the loader has done it.
void start_clocks();

/// Runs TIM2 at 1 MHz: 32 bits in hardware, extended to 64 on each reading, so it must be read at least every 71
/// minutes.
void start_microseconds();
/// Returns the time since start_microseconds() in µs; monotonic. May be called from interrupts.
[[nodiscard]] std::uint64_t microseconds();
/// Requests an interrupt at or soon after `at_us`, to end a sleep.
void wake_at(std::uint64_t at_us);

/// Starts the IWDG with 32 kHz / 32 · 2000 = 2 s. It cannot be stopped; it stands while a debugger holds the core.
void start_watchdog();
/// Feeds the watchdog; harmless before the start. 1.7 s after the last call, an interrupt records where the program
/// hangs and resets the controller. The watchdog itself is for a program that has disabled interrupts.
void feed_watchdog();

/// Returns the 96-bit device id of this chip in the order of its bytes in memory.
[[nodiscard]] wire::UniqueId unique_id();

/// Erases a page of the flash (RM0440 §3.3.6, §3.3.7) and waits for the end: 22 ms, or 82 µs for a unit of eight
/// bytes when programming. Code that reads the bank being written stalls until the end, so code that must continue runs
/// from RAM. The data cache is off during that time. Returns false: refused, misaligned, write protected, the unit was
/// not erased, or pages are not of 2 KB (DBANK = 0).
[[nodiscard]] bool erase_flash_page(std::uint32_t address);
/// Programs eight bytes at an address that is a multiple of 8, `low` first. Returns false in the cases of
/// erase_flash_page.
[[nodiscard]] bool program_flash_unit(std::uint32_t address, std::uint32_t low, std::uint32_t high);

/// Returns faults of this board as bits of `finding`. It reads the option bytes and the boot pin, so it must run at
/// start, before CAN.
[[nodiscard]] std::uint32_t inspect_board();
/// Sets the option bits that start the flash whatever the boot pin says (nSWBOOT0 = 0, nBOOT0 = 1), and those that keep
/// the chip in reset below 2.8 V, because converters need 2.6 V. They apply from the next power-up. A power failure
/// during its 25 ms may leave the chip read protected, so call it only while the supply is stable. Returns false: not
/// allowed on this chip, or refused.
[[nodiscard]] bool set_options_of_a_board();
[[nodiscard]] bool write_flash_options(std::uint32_t options);
[[nodiscard]] bool write_flash_protection(std::uint32_t pages);
/// Protects the pages of the loader against erasing and programming, or releases them, from the next power-up on. It
/// returns false in the cases of set_options_of_a_board() and needs a stable supply as well.
[[nodiscard]] bool protect_loader(bool on);

/// The work continues during an erase, so neither function may read or write the flash.
struct BusyWork {
  void (*step)();  ///< The function performs the work that is due.
  /// The function returns when step() has work next, or 0 for now; it is called with interrupts disabled.
  std::uint64_t (*next_us)();
};
/// `work` must outlive the calls that erase; null means that the processor sleeps through an erase.
void do_while_erasing(const BusyWork* work);

/// Returns the address of the running image in the flash, which begins with its vectors.
[[nodiscard]] std::uint32_t image_origin();

/// Asks the loader to become a DFU device after the next reset; the loader accepts the request once.
void request_dfu();
/// Returns true once after request_dfu() and a reset; false after power-up.
[[nodiscard]] bool take_dfu_request();

}  // namespace triskin::board

// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>

#include "triskin/wire/unique_id.hpp"

/// Low-level parts that the loader and the application share.
namespace triskin::board {

/// Measures the crystal against the internal oscillator and runs the PLL at 320 MHz from it; SYSCLK = HCLK = PCLK =
/// 160 MHz, range 1 boost, four wait states (RM0440 §6.1.5, §7.2.4, §3.3.3). From the internal oscillator (± 1 %:
/// enough for I²C and, as a rule, for classic CAN) when the crystal is missing, unknown or fails. Says in
/// survivor().clock what was chosen and why. At most 70 ms; does nothing when the loader has done it.
void start_clocks();

/// TIM2 at 1 MHz: 32 bits in hardware, extended to 64 on each reading; must be read at least every 71 minutes.
void start_microseconds();
/// Time since start_microseconds(), µs; monotonic. May be called from interrupts.
[[nodiscard]] std::uint64_t microseconds();
/// An interrupt at or soon after `at_us`, to end a sleep.
void wake_at(std::uint64_t at_us);

/// IWDG, 32 kHz / 32 · 2000 = 2 s. Cannot be stopped.
void start_watchdog();
/// Harmless before the start. 1.7 s after the last call an interrupt notes where the program hangs and resets the
/// controller; the watchdog itself is for a program that has switched interrupts off.
void feed_watchdog();

/// The 96-bit device id of this chip, as its bytes stand in memory.
[[nodiscard]] wire::UniqueId unique_id();

/// Flash (RM0440 §3.3.6, §3.3.7). Waits for the end: 22 ms an erase, 82 µs a unit of eight bytes. Whoever reads the
/// bank that is written is stalled to the end: code that must go on runs from RAM. The data cache is off meanwhile.
/// False: refused, misaligned, write protected, the unit was not erased, or pages are not of 2 KB (DBANK = 0).
[[nodiscard]] bool erase_flash_page(std::uint32_t address);
/// Programs eight bytes at an address that is a multiple of 8, `low` first. False: as for erase_flash_page.
[[nodiscard]] bool program_flash_unit(std::uint32_t address, std::uint32_t low, std::uint32_t high);

/// Returns faults of this board as bits of `finding`. Reads the option bytes and the boot pin; at start, before CAN.
[[nodiscard]] std::uint32_t inspect_board();
/// Sets the option bits that start the flash whatever the boot pin says (nSWBOOT0 = 0, nBOOT0 = 1) and those that hold
/// the chip in reset below 2.8 V: converters need 2.6 V. They count from the next power-up. A power cut within its 25
/// ms may leave the chip read protected: only while the supply stands. False: not allowed on this chip, or refused.
[[nodiscard]] bool set_options_of_a_board();
[[nodiscard]] bool write_flash_options(std::uint32_t options);
[[nodiscard]] bool write_flash_protection(std::uint32_t pages);
/// Protects the pages of the loader against erasing and programming, or releases them, from the next power-up on.
/// False: as for set_options_of_a_board(), and as careful: only while the supply stands.
[[nodiscard]] bool protect_loader(bool on);

/// What goes on while an erase lasts. Neither function may read the flash or write it.
struct BusyWork {
  void (*step)();  ///< It does what is due.
  /// It returns when step() has work next, or 0 for now, and is asked with interrupts off.
  std::uint64_t (*next_us)();
};
/// `work` outlives the calls that erase; null: the processor sleeps through an erase.
void do_while_erasing(const BusyWork* work);

/// Address of the running image in the flash, which begins with its vectors.
[[nodiscard]] std::uint32_t image_origin();

/// Asks the loader to become a DFU device after the next reset; the loader takes the request once.
void request_dfu();
/// True once after request_dfu() and a reset; false after power-up.
[[nodiscard]] bool take_dfu_request();

}  // namespace triskin::board

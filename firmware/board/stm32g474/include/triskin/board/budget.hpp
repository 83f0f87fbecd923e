// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace triskin::board {

/// Faults of a board that are found at its start: bits of Budget::findings. docs/bring_up.md says what to do.
namespace finding {
inline constexpr std::uint32_t kSingleBank = 1;   ///< DBANK = 0: the flash has other pages, nothing is erased
inline constexpr std::uint32_t kBootByPin = 2;    ///< nSWBOOT0 = 1: an idle CAN bus at BOOT0 starts the ROM's loader
inline constexpr std::uint32_t kBootPinHigh = 4;  ///< PB8 was high at start
inline constexpr std::uint32_t kOptionsProtected = 8;  ///< read protected: the options are left alone
inline constexpr std::uint32_t kNoCrystal = 16;        ///< the clock is not the crystal's: FD11 says why
inline constexpr std::uint32_t kLowBrownOut = 32;      ///< the chip would run below 2.8 V, where converters do not
inline constexpr std::uint32_t kLoaderProtected = 64;  ///< the loader's pages are write-protected, for information
}  // namespace finding

/// Measurements of the firmware about itself. At a fixed symbol (`triskin_budget`), so that a debugger or the modelled
/// machine reads it.
struct Budget {
  std::uint32_t loops = 0;          ///< passes of the main loop
  std::uint32_t worst_loop_us = 0;  ///< longest pass, sleep left out
  std::uint32_t worst_interrupt_us = 0;
  std::uint32_t stack_free_bytes = 0;    ///< bytes of the painted stack that were never touched
  std::uint64_t idle_us = 0;             ///< time spent in WFI since start
  std::uint32_t reset_cause = 0;         ///< RCC_CSR as found at start
  std::uint32_t ecc_faults = 0;          ///< flash units read with two wrong bits: torn by a power cut
  std::uint32_t can_lost = 0;            ///< frames that found the receive queue full
  std::uint32_t flash_errors = 0;        ///< erase or program refused
  std::uint32_t bus_errors = 0;          ///< I²C bus errors seen in transfers that went on: spurious (ES0430, 2.15.2)
  std::uint32_t options = 0;             ///< FLASH_OPTR as found at start
  std::uint32_t findings = 0;            ///< bits of `finding`
  std::uint32_t ecc_corrected = 0;       ///< flash units read with one wrong bit
  std::uint32_t arbitration_losses = 0;  ///< I²C transfers that were made again: a disturbance looked like a master
};

}  // namespace triskin::board

extern "C" triskin::board::Budget triskin_budget;

// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace triskin::board {

/// Faults of a board that are found at its start: bits of Budget::findings. docs/bring_up.md says what to do.
namespace finding {
inline constexpr std::uint32_t kSingleBank = 1;  ///< With DBANK = 0 the flash has other pages, so nothing is erased.
/// With nSWBOOT0 = 1 an idle CAN bus at BOOT0 starts the ROM's loader.
inline constexpr std::uint32_t kBootByPin = 2;
inline constexpr std::uint32_t kBootPinHigh = 4;  ///< PB8 was high at start, which would start the ROM's loader.
/// The flash is read protected, so the options are left alone.
inline constexpr std::uint32_t kOptionsProtected = 8;
inline constexpr std::uint32_t kNoCrystal = 16;        ///< The clock is not the crystal's; FD11 says why.
inline constexpr std::uint32_t kLowBrownOut = 32;      ///< The chip would run below 2.8 V, where converters do not.
inline constexpr std::uint32_t kLoaderProtected = 64;  ///< the loader's pages are write-protected, for information
}  // namespace finding

/// Measurements of the firmware about itself. At a fixed symbol (`triskin_budget`), so that a debugger or the modelled
/// machine reads it.
struct Budget {
  std::uint32_t loops = 0;          ///< It counts passes of the main loop.
  std::uint32_t worst_loop_us = 0;  ///< It is the longest pass, sleep left out.
  std::uint32_t worst_interrupt_us = 0;
  std::uint32_t stack_free_bytes = 0;  ///< So many bytes of the painted stack were never touched.
  std::uint64_t idle_us = 0;           ///< It is the time spent in WFI since start.
  std::uint32_t reset_cause = 0;       ///< It is RCC_CSR as found at start.
  std::uint32_t ecc_faults = 0;        ///< It counts flash units read with two wrong bits, as a power cut tears them.
  std::uint32_t can_lost = 0;          ///< It counts frames that found the receive queue full.
  std::uint32_t flash_errors = 0;      ///< It counts erase and program operations that were refused.
  /// It counts I²C bus errors in transfers that went on, which are spurious (ES0430, 2.15.2).
  std::uint32_t bus_errors = 0;
  std::uint32_t options = 0;        ///< It is FLASH_OPTR as found at start.
  std::uint32_t findings = 0;       ///< Its bits are those of `finding`.
  std::uint32_t ecc_corrected = 0;  ///< It counts flash units read with one wrong bit.
  /// It counts I²C transfers that were made again because a disturbance looked like a master.
  std::uint32_t arbitration_losses = 0;
};

}  // namespace triskin::board

extern "C" triskin::board::Budget triskin_budget;

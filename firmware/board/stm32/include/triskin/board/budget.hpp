// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace triskin::board {

/// These faults of a board are found at its start and reported as bits of Budget::findings. docs/bring_up.md has the
/// remedies.
namespace finding {
inline constexpr std::uint32_t kSingleBank = 1;  ///< With DBANK = 0 the flash has other pages, so nothing is erased.
/// With nSWBOOT0 = 1 an idle CAN bus at BOOT0 starts the ROM's loader.
inline constexpr std::uint32_t kBootByPin = 2;
inline constexpr std::uint32_t kBootPinHigh = 4;  ///< PB8 was high at start, which would start the ROM's loader.
/// The flash is read protected, so the options are not changed.
inline constexpr std::uint32_t kOptionsProtected = 8;
inline constexpr std::uint32_t kNoCrystal = 16;    ///< The clock does not come from the crystal; FD11 says why.
inline constexpr std::uint32_t kLowBrownOut = 32;  ///< The chip would run below 2.8 V, where converters do not work.
inline constexpr std::uint32_t kLoaderProtected = 64;  ///< The loader's pages are write-protected; this is no fault.
}  // namespace finding

/// The firmware measures itself. The results have a fixed symbol (`triskin_budget`), so that a debugger or the modelled
/// machine can read them.
struct Budget {
  std::uint32_t loops = 0;          ///< Each pass of the main loop counts.
  std::uint32_t worst_loop_us = 0;  ///< The longest pass does not include sleep.
  std::uint32_t worst_interrupt_us = 0;
  std::uint32_t stack_free_bytes = 0;  ///< This many bytes of the painted stack were never touched.
  std::uint64_t idle_us = 0;           ///< The time in WFI is counted from the start.
  std::uint32_t reset_cause = 0;       ///< RCC_CSR had this value at start.
  /// A power failure leaves flash units that read with two wrong bits, which are counted here.
  std::uint32_t ecc_faults = 0;
  std::uint32_t can_lost = 0;      ///< The receive queue was full when these frames arrived.
  std::uint32_t flash_errors = 0;  ///< Refused erase and program operations are counted here.
  /// I²C bus errors in transfers that continued are spurious (ES0430, 2.15.2).
  std::uint32_t bus_errors = 0;
  std::uint32_t options = 0;        ///< FLASH_OPTR had this value at start.
  std::uint32_t findings = 0;       ///< The bits are those of `finding`.
  std::uint32_t ecc_corrected = 0;  ///< Flash units read with one wrong bit are counted here.
  /// These I²C transfers were repeated because a disturbance looked like another master.
  std::uint32_t arbitration_losses = 0;
};

}  // namespace triskin::board

extern "C" triskin::board::Budget triskin_budget;

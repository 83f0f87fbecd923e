// SPDX-License-Identifier: Apache-2.0
#include "triskin/board/board.hpp"
#include "triskin/board/budget.hpp"
#include "triskin/board/registers/pins.hpp"
#include "triskin/board/registers/system.hpp"
#include "triskin/board/survivor.hpp"

namespace triskin::board {

using namespace flash_reg;

std::uint32_t inspect_board() {
  rcc_reg::kAhb2Enr.set(rcc_reg::kGpioB);
  (void)rcc_reg::kAhb2Enr.read();
  const Gpio boot_pin(pins::kCanReceive);
  if (boot_pin.analog()) boot_pin.mode(PinMode::kInput);
  asm volatile("nop\n nop\n nop\n nop" ::: "memory");  // The input is sampled with the bus clock.
  const std::uint32_t options = kOptr.read();
  triskin_budget.options = options;
  std::uint32_t found = 0;
  if ((options & kDualBank) == 0) found |= finding::kSingleBank;
  if ((options & kBootByPin) != 0) found |= finding::kBootByPin;
  if (boot_pin.level()) found |= finding::kBootPinHigh;
  if ((options & kBrownOutMask) < kBrownOut28) found |= finding::kLowBrownOut;
  if (survivor().clock.crystal != wire::Crystal::kUsed) found |= finding::kNoCrystal;
  if ((options & kReadProtectionMask) != kNotProtected) found |= finding::kOptionsProtected;
  return found;
}

// RM0440 §3.4.2. The chip follows the new bytes after its next power-up.
bool set_options_of_a_board() {
  const std::uint32_t options = kOptr.read();
  if ((options & kReadProtectionMask) != kNotProtected || (options & kDualBank) == 0) return false;
  return write_flash_options((options & ~(kBootByPin | kBrownOutMask)) | kBootOptionFlash | kBrownOut28);
}

}  // namespace triskin::board

// SPDX-License-Identifier: Apache-2.0
#include "triskin/board/board.hpp"
#include "triskin/board/board_config.hpp"
#include "triskin/board/budget.hpp"
#include "triskin/board/flash_map.hpp"
#include "triskin/board/registers/system.hpp"
#include "triskin/board/survivor.hpp"

namespace triskin::board {

using namespace flash_reg;

namespace {

// The field covers the first page of the bank up to the last one of the loader.
constexpr std::uint32_t kLoaderPages = (flash_map::kLoaderBytes / flash_map::kPageBytes - 1) << kLastProtectedShift;
static_assert(flash_map::kLoader == flash_map::kBase);

// kDualBank has no bit on a chip with one bank.
bool pages_as_mapped(std::uint32_t options) {
  return (options & kDualBank) == kDualBank;
}

bool options_can_be_set(std::uint32_t options) {
  return (options & kReadProtectionMask) == kNotProtected && pages_as_mapped(options);
}

}  // namespace

std::uint32_t inspect_board() {
  open_port(pins::kBoot);
  const Gpio boot_pin(pins::kBoot);
  if (boot_pin.analog()) boot_pin.mode(PinMode::kInput);
  asm volatile("nop\n nop\n nop\n nop" ::: "memory");  // The input is sampled with the bus clock.
  const std::uint32_t options = kOptr.read();
  triskin_budget.options = options;
  std::uint32_t found = 0;
  if (!pages_as_mapped(options)) found |= finding::kSingleBank;
  if ((options & kBootByPin) != 0) found |= finding::kBootByPin;
  if (boot_pin.level()) found |= finding::kBootPinHigh;
  if ((options & kBrownOutMask) < kBrownOut28) found |= finding::kLowBrownOut;
  if (survivor().clock.crystal != wire::Crystal::kUsed) found |= finding::kNoCrystal;
  if (kWrp1Ar.read() == kLoaderPages) found |= finding::kLoaderProtected;
  if ((options & kReadProtectionMask) != kNotProtected) found |= finding::kOptionsProtected;
  return found;
}

bool set_options_of_a_board() {
  const std::uint32_t options = kOptr.read();
  if (!options_can_be_set(options)) return false;
  return write_flash_options((options & ~(kBootByPin | kBrownOutMask)) | kBootOptionFlash | kBrownOut28);
}

bool protect_loader(bool on) {
  const std::uint32_t pages = on ? kLoaderPages : kProtectsNothing;
  if (!options_can_be_set(kOptr.read())) return false;
  return kWrp1Ar.read() == pages || write_flash_protection(pages);
}

}  // namespace triskin::board

// SPDX-License-Identifier: GPL-3.0-or-later
#include "triskin/machine/flash_controller.hpp"

#include <fmt/format.h>

#include <utility>

#include "triskin/machine/map_l452.hpp"

namespace triskin::machine {
namespace {

constexpr std::uint32_t kOptionLock = 1U << 30, kOptionStart = 1U << 17, kOptionLaunch = 1U << 27,
                        kDataCache = 1U << 10, kDataCacheReset = 1U << 12, kInstructionCache = 1U << 9,
                        kInstructionCacheReset = 1U << 11, kDebugger = 1U << 18, kErrorInterrupt = 1U << 25;
constexpr std::uint32_t kLock = 1U << 31, kBusy = 1U << 16, kStart = 1U << 16, kEccDetected = 1U << 31,
                        kEccCorrected = 1U << 30, kEccFlags = 0xF0000000;
constexpr std::uint32_t kProgError = 1U << 3, kProtectionError = 1U << 4, kAlignError = 1U << 5, kSizeError = 1U << 6,
                        kSequenceError = 1U << 7;

}  // namespace

void FlashController::reset() {
  ++generation_;
  acr_ = one_bank_ ? map::l452::kAcrReset : map::kAcrReset;
  rcc_.set_wait_states(acr_ & 15);
  sr_ = eccr_ = 0;
  cr_ = map::kFlashCrReset;
  keys_ = option_keys_ = 0;
  if (std::exchange(launch_, false)) load_options();
  options_ = loaded_options_;
  protection_ = loaded_protection_;
  locked_out_ = half_waits_ = busy_ = stale_ = false;
}

std::uint32_t FlashController::read(std::uint32_t offset, unsigned) {
  switch (offset) {
    case 0x00:
      return acr_;
    case 0x10:
      return sr_;
    case 0x14:
      return cr_;
    case 0x18:
      return eccr_;
    case 0x20:
      return options_;
    case 0x2C:
      return protection_;
    default:
      return 0;
  }
}

void FlashController::error(std::uint32_t flag, const char* what) {
  sr_ |= flag | ((cr_ & kErrorInterrupt) != 0 ? 2U : 0U);  // OPERR is set only with its interrupt enabled (§3.7.5).
  around_.violation(what);
}

// A wrong key or order locks the register until the next reset (§3.3.5).
void FlashController::write_key(std::uint32_t value) {
  constexpr std::uint32_t kKeys[2] = {0x45670123, 0xCDEF89AB};
  if (locked_out_ || (cr_ & kLock) == 0 || value != kKeys[keys_]) {
    locked_out_ = true;
    cr_ |= kLock;
    around_.violation("FLASH_KEYR: wrong key or order; locked until reset");
    return;
  }
  if (++keys_ == 2) {
    cr_ &= ~kLock;
    keys_ = 0;
  }
}

// A cache may be reset only while it is off (§3.7.1). Data that an erase left in the data cache must be removed before
// it is on again.
void FlashController::write_access(std::uint32_t value) {
  if ((value & kDataCacheReset) != 0 && (acr_ & kDataCache) != 0)
    around_.violation("FLASH_ACR.DCRST written while the data cache is on");
  if ((value & kInstructionCacheReset) != 0 && (acr_ & kInstructionCache) != 0)
    around_.violation("FLASH_ACR.ICRST written while the instruction cache is on");
  if ((acr_ & kDebugger) != 0 && (value & kDebugger) == 0)
    around_.violation("FLASH_ACR.DBG_SWEN cleared: the debugger is shut out");
  if ((value & kDataCacheReset) != 0) stale_ = false;
  if ((value & kDataCache) != 0 && stale_) around_.violation("data cache on with what it held before an erase");
  if ((value & kDataCache) != 0 && busy_) around_.violation("data cache switched on while the flash is written");
  acr_ = value;
  rcc_.set_wait_states(value & 15);
}

void FlashController::write_option_key(std::uint32_t value) {
  constexpr std::uint32_t kKeys[2] = {0x08192A3B, 0x4C5D6E7F};
  if ((cr_ & kLock) != 0 || (cr_ & kOptionLock) == 0 || value != kKeys[option_keys_]) {
    around_.violation("FLASH_OPTKEYR: wrong key or order, or FLASH_CR locked");
    return;
  }
  if (++option_keys_ < 2) return;
  cr_ &= ~kOptionLock;
  option_keys_ = 0;
}

// By errata ES0430, 2.2.2, reading one bank while the other is written may corrupt the data cache.
void FlashController::check_data_cache() {
  if (around_.core_runs() && (acr_ & kDataCache) != 0) around_.violation("flash written with the data cache on");
}

// The new bytes are in the cells; the chip uses them after the next power-up, or when they are loaded (§3.4.2).
void FlashController::start_options() {
  check_data_cache();
  sr_ |= kBusy;
  busy_ = true;
  busy_bank_ = 0;
  busy_until_ = around_.time().now() + kEraseTime;
  around_.time().after(kEraseTime, [this, g = generation_, options = options_, protection = protection_] {
    if (g != generation_) return;
    chip_.options = options;
    chip_.write_protection = protection;
    busy_ = false;
    sr_ &= ~kBusy;
  });
}

// Loading the option bytes resets the system; the flag in RCC_CSR says so.
void FlashController::launch_options() {
  launch_ = true;
  around_.request_reset(1U << 25);
}

void FlashController::write(std::uint32_t offset, std::uint32_t value, unsigned) {
  switch (offset) {
    case 0x00:
      write_access(value);
      break;
    case 0x08:
      write_key(value);
      break;
    case 0x0C:
      write_option_key(value);
      break;
    case 0x20:
      if ((cr_ & kOptionLock) != 0)
        around_.violation("FLASH_OPTR written while locked");
      else
        options_ = value;
      break;
    case 0x2C:
      if ((cr_ & kOptionLock) != 0)
        around_.violation("FLASH_WRP1AR written while locked");
      else
        protection_ = value;
      break;
    case 0x10:
      sr_ &= ~(value & 0xC3FB);
      break;
    case 0x14:
      write_control(value);
      break;
    case 0x18:
      eccr_ &= ~(value & kEccFlags);
      break;
    default:
      around_.violation(fmt::format("FLASH register {:#x} is not modelled", offset));
  }
}

void FlashController::write_control(std::uint32_t value) {
  if ((cr_ & kLock) != 0) {
    around_.violation("FLASH_CR written while locked");
    return;
  }
  if ((sr_ & kBusy) != 0) {
    around_.violation("FLASH_CR written while busy");
    return;
  }
  const bool options_open = (cr_ & kOptionLock) == 0 && (value & kOptionLock) == 0;
  cr_ = (options_open ? 0U : kOptionLock) | (value & ~(kOptionLock | kOptionStart | kOptionLaunch));
  if ((cr_ & kLock) != 0) cr_ |= kOptionLock;
  if ((value & kOptionStart) != 0 && !options_open)
    return around_.violation("FLASH_CR.OPTSTRT while options are locked");
  if ((value & kOptionStart) != 0) return start_options();
  if ((value & kOptionLaunch) != 0 && !options_open)
    return around_.violation("FLASH_CR.OBL_LAUNCH while options are locked");
  if ((value & kOptionLaunch) != 0) return launch_options();
  if ((cr_ & kStart) == 0) return;
  cr_ &= ~kStart;
  if ((cr_ & 2) == 0 || (cr_ & 1) != 0)
    error(kSequenceError, "FLASH_CR.STRT without page erase, or with programming");
  else
    start_erase();
}

// Counts the operation; if power fails in it, half of it has happened.
void FlashController::begin(Time typical, const FlashOperation& operation) {
  const auto duration = static_cast<Time>(static_cast<double>(typical) * time_factor_);
  check_data_cache();
  sr_ |= kBusy;
  busy_ = true;
  stale_ = stale_ || operation.erase;
  const std::uint32_t units =
      operation.erase ? FlashChip::kBytes / FlashChip::kPage : FlashChip::kBytes / FlashChip::kUnit;
  busy_bank_ = operation.index / (units / 2);
  busy_until_ = around_.time().now() + duration;
  const bool cut = chip_.operations++ == chip_.cut_at;
  if (chip_.log != nullptr) chip_.log->push_back(operation);
  around_.time().after(cut ? duration / 2 : duration, [this, cut, operation, g = generation_] {
    chip_.apply(operation, cut);
    const std::uint32_t size = operation.erase ? FlashChip::kPage : FlashChip::kUnit;
    changed_(FlashChip::kBase + operation.index * size, size);
    power_lost_ = power_lost_ || cut;
    if (g != generation_) return;
    busy_ = false;
    sr_ &= ~kBusy;
  });
}

// Covers area A of bank 1 (§3.7.11); the protected pages follow the option bytes as they were last loaded.
bool FlashController::is_protected(std::uint32_t page) const {
  return page >= (loaded_protection_ & page_mask()) && page <= (loaded_protection_ >> 16 & page_mask());
}

void FlashController::start_erase() {
  if (!one_bank_ && !two_banks())
    around_.violation("page erase with DBANK = 0: pages have 4 KB, a neighbour is erased along");
  const bool second = (cr_ >> 11 & 1) != 0;
  if (one_bank_ && second) around_.violation("FLASH_CR bit 11 set on a chip with one bank");
  const std::uint32_t page = cr_ >> 3 & page_mask();
  if (!second && is_protected(page)) return error(kProtectionError, "erase of a write-protected page");
  begin(kEraseTime, {true, page + (second ? 128 : 0), 0});
}

void FlashController::cell_write(std::uint32_t address, std::uint32_t value, unsigned size) {
  if ((cr_ & kLock) != 0 || (cr_ & 1) == 0) {
    error(kSequenceError, (cr_ & kLock) != 0 ? "write to a locked flash" : "write to the flash without FLASH_CR.PG");
    return;
  }
  if ((sr_ & kBusy) != 0) {
    error(kSequenceError, "write to a busy flash");
    return;
  }
  if (size != 4) {
    error(kSizeError, "flash written in bytes or half-words");
    return;
  }
  if (!half_waits_) {
    if (address % FlashChip::kUnit != 0) {
      error(kAlignError, "flash unit begun in its middle");
      return;
    }
    half_waits_ = true;
    half_address_ = address;
    words_[0] = value;
    return;
  }
  half_waits_ = false;
  if (address != half_address_ + 4) {
    error(kAlignError, "second word of a flash unit is elsewhere");
    return;
  }
  words_[1] = value;
  program_unit();
}

// Only erased units can be programmed, but all zeros may be written over anything (§3.3.8).
void FlashController::program_unit() {
  const std::uint32_t unit = (half_address_ - FlashChip::kBase) / FlashChip::kUnit;
  if (is_protected(unit * FlashChip::kUnit / FlashChip::kPage))
    return error(kProtectionError, "flash unit of a write-protected page programmed");
  if (chip_.used[unit] && (words_[0] | words_[1]) != 0) {
    error(kProgError, "flash unit programmed twice");
    return;
  }
  begin(kProgramTime, {false, unit, words_[0] | static_cast<std::uint64_t>(words_[1]) << 32});
}

// With DBANK = 0 the flash is read by two units at once, and the upper one has flags of its own (§3.7.7).
void FlashController::flawed_read(std::uint32_t unit) {
  if (one_bank_ || two_banks()) return note_flaw(unit, false);
  note_flaw(unit & ~1U, false);
  note_flaw(unit | 1U, true);
}

// One wrong bit is corrected, two raise the NMI. The register keeps the place of the first error until its flag is
// cleared.
void FlashController::note_flaw(std::uint32_t unit, bool upper) {
  const bool torn = chip_.torn.contains(unit);
  if (!torn && !chip_.weak.contains(unit)) return;
  constexpr std::uint32_t kUnitsOfBank = FlashChip::kBytes / FlashChip::kUnit / 2;
  if ((eccr_ & kEccFlags) == 0)
    eccr_ =
        one_bank_ ? unit * FlashChip::kUnit : (unit / kUnitsOfBank) << 21 | (unit % kUnitsOfBank) * FlashChip::kUnit;
  eccr_ |= (torn ? kEccDetected : kEccCorrected) >> (upper ? 2 : 0);
  if (torn) around_.raise_nmi();
}

bool FlashController::nmi_pending() const {
  return (eccr_ & (kEccDetected | kEccDetected >> 2)) != 0;
}

}  // namespace triskin::machine

// SPDX-License-Identifier: GPL-3.0-or-later
#include "flash_controller.hpp"

#include <fmt/format.h>

#include <utility>

namespace triskin::machine {
namespace {

constexpr std::uint32_t kLock = 1U << 31, kBusy = 1U << 16, kStart = 1U << 16, kEcc = 1U << 31;
constexpr std::uint32_t kProgError = 1U << 3, kAlignError = 1U << 5, kSizeError = 1U << 6, kSequenceError = 1U << 7;

}  // namespace

void FlashController::reset() {
  ++generation_;
  acr_ = map::kAcrReset;
  rcc_.set_wait_states(acr_ & 15);
  sr_ = eccr_ = 0;
  cr_ = map::kFlashCrReset;
  keys_ = 0;
  locked_out_ = half_waits_ = false;
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
      return chip_.options;
    default:
      return 0;
  }
}

void FlashController::error(std::uint32_t flag, const char* what) {
  sr_ |= flag | 2;
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

void FlashController::write(std::uint32_t offset, std::uint32_t value, unsigned) {
  switch (offset) {
    case 0x00:
      acr_ = value;
      rcc_.set_wait_states(value & 15);
      break;
    case 0x08:
      write_key(value);
      break;
    case 0x10:
      sr_ &= ~(value & 0xC3FB);
      break;
    case 0x14:
      write_control(value);
      break;
    case 0x18:
      eccr_ &= ~(value & 0xC0000000);
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
  cr_ = (cr_ & 0x40000000) | (value & 0x8FFFFFFF);
  if ((cr_ & kStart) == 0) return;
  cr_ &= ~kStart;
  if ((cr_ & 2) == 0 || (cr_ & 1) != 0)
    error(kSequenceError, "FLASH_CR.STRT without page erase, or with programming");
  else
    start_erase();
}

// Counts the operation; when power fails in it, half of it has happened.
void FlashController::begin(Time duration, const FlashOperation& operation) {
  sr_ |= kBusy;
  const bool cut = chip_.operations++ == chip_.cut_at;
  if (chip_.log != nullptr) chip_.log->push_back(operation);
  around_.time().after(cut ? duration / 2 : duration, [this, cut, operation, g = generation_] {
    chip_.apply(operation, cut);
    const std::uint32_t size = operation.erase ? FlashChip::kPage : FlashChip::kUnit;
    changed_(FlashChip::kBase + operation.index * size, size);
    power_lost_ = power_lost_ || cut;
    if (g != generation_) return;
    sr_ = (sr_ & ~kBusy) | 1;
  });
}

void FlashController::start_erase() {
  begin(kEraseTime, {true, (cr_ >> 3 & 127) + ((cr_ >> 11 & 1) != 0 ? 128 : 0), 0});
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

// Erased units only; all zeros may be written over anything (§3.3.8).
void FlashController::program_unit() {
  const std::uint32_t unit = (half_address_ - FlashChip::kBase) / FlashChip::kUnit;
  if (chip_.used[unit] && (words_[0] | words_[1]) != 0) {
    error(kProgError, "flash unit programmed twice");
    return;
  }
  begin(kProgramTime, {false, unit, words_[0] | static_cast<std::uint64_t>(words_[1]) << 32});
}

void FlashController::torn_read(std::uint32_t unit) {
  if (!chip_.torn.contains(unit)) return;
  eccr_ = kEcc | unit;
  around_.raise_nmi();
}

}  // namespace triskin::machine

// SPDX-License-Identifier: Apache-2.0
#include "triskin/board/board.hpp"
#include "triskin/board/budget.hpp"
#include "triskin/board/flash_map.hpp"
#include "triskin/board/registers/system.hpp"

namespace triskin::board {
namespace {

constexpr std::uint64_t kLook_us = 500;

// Keeps the control register unlocked for one operation only: a runaway program cannot write.
class Unlocked {
 public:
  Unlocked() {
    flash_reg::kKeyr.write(flash_reg::kKey1);
    flash_reg::kKeyr.write(flash_reg::kKey2);
  }
  ~Unlocked() { flash_reg::kCr.write(flash_reg::kLock); }
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;
};

void wait_ready() {
  while (flash_reg::kSr.any(flash_reg::kBusy)) {
  }
}

// An erase takes 22 ms: sleep between the looks. Interrupts, among them those of the I²C lines, go on.
void sleep_while_busy() {
  while (flash_reg::kSr.any(flash_reg::kBusy)) {
    wake_at(microseconds() + kLook_us);
    asm volatile("dsb\n wfi" ::: "memory");
  }
}

bool finish() {
  wait_ready();
  const std::uint32_t status = flash_reg::kSr.read();
  flash_reg::kSr.write(flash_reg::kErrors | flash_reg::kEndOfOperation);
  if ((status & flash_reg::kErrors) == 0) return true;
  ++triskin_budget.flash_errors;
  return false;
}

// The data cache keeps what was erased or programmed (§3.3.4): it is emptied by hand.
void flush_data_cache() {
  const std::uint32_t was = flash_reg::kAcr.read();
  flash_reg::kAcr.write(was & ~flash_reg::kDataCache);
  flash_reg::kAcr.write((was & ~flash_reg::kDataCache) | flash_reg::kDataCacheReset);
  flash_reg::kAcr.write(was);
}

bool in_flash(std::uint32_t address) {
  return address >= flash_map::kBase && address < flash_map::kEnd;
}

}  // namespace

bool erase_flash_page(std::uint32_t address) {
  if (!in_flash(address) || address % flash_map::kPageBytes != 0) return false;
  const bool second = address >= flash_map::kBank2;
  const std::uint32_t page = (address - (second ? flash_map::kBank2 : flash_map::kBase)) / flash_map::kPageBytes;
  wait_ready();
  const Unlocked unlocked;
  flash_reg::kSr.write(flash_reg::kErrors | flash_reg::kEndOfOperation);
  const std::uint32_t command =
      flash_reg::kPageErase | page << flash_reg::kPageShift | (second ? flash_reg::kBank2 : 0U);
  flash_reg::kCr.write(command);
  flash_reg::kCr.write(command | flash_reg::kStart);
  sleep_while_busy();
  const bool good = finish();
  flush_data_cache();
  return good;
}

bool program_flash_unit(std::uint32_t address, std::uint32_t low, std::uint32_t high) {
  if (!in_flash(address) || address % flash_map::kUnitBytes != 0) return false;
  wait_ready();
  const Unlocked unlocked;
  flash_reg::kSr.write(flash_reg::kErrors | flash_reg::kEndOfOperation);
  flash_reg::kCr.write(flash_reg::kProgram);
  {
    const InterruptLock lock;  // nothing may come between the two halves of a unit
    Register(address).write(low);
    Register(address + 4).write(high);
  }
  const bool good = finish();
  flush_data_cache();
  return good;
}

}  // namespace triskin::board

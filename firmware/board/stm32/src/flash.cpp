// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "triskin/board/board.hpp"
#include "triskin/board/budget.hpp"
#include "triskin/board/flash_map.hpp"
#include "triskin/board/registers/system.hpp"

namespace triskin::board {
namespace {

constexpr std::uint64_t kLook_us = 500;
const BusyWork* busy_work = nullptr;

// Keeps the control register unlocked for one operation only, so that a runaway program cannot write.
class Unlocked {
 public:
  Unlocked() {
    flash_reg::kKeyr.write(flash_reg::kKey1);
    flash_reg::kKeyr.write(flash_reg::kKey2);
  }
  ~Unlocked() { flash_reg::kCr.write(flash_reg::kLock | flash_reg::kOptionLock); }
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;
};

void wait_ready() {
  while (flash_reg::kSr.any(flash_reg::kBusy)) {
  }
}

// An erase takes 22 ms. In this time the board's busy work runs; otherwise the processor sleeps between the polls.
void wait_through_erase() {
  while (flash_reg::kSr.any(flash_reg::kBusy)) {
    if (busy_work != nullptr) busy_work->step();
    asm volatile("cpsid i" ::: "memory");  // No interrupt may come between the decision and WFI.
    const std::uint64_t now_us = microseconds(), next_us = busy_work != nullptr ? busy_work->next_us() : UINT64_MAX;
    if (next_us > now_us) {
      wake_at(std::min(next_us, now_us + kLook_us));
      asm volatile("dsb\n wfi" ::: "memory");
    }
    asm volatile("cpsie i\n isb" ::: "memory");
  }
}

bool end_operation() {
  wait_ready();
  const std::uint32_t status = flash_reg::kSr.read();
  flash_reg::kSr.write(flash_reg::kErrors | flash_reg::kEndOfOperation);
  if ((status & flash_reg::kErrors) == 0) return true;
  ++triskin_budget.flash_errors;
  return false;
}

// The data cache may be corrupted when one bank is read while the other is written (errata ES0430, 2.2.2). It is off
// during a write and flushed before it is on again, because it keeps erased data (§3.3.7).
class DataCacheOff {
 public:
  DataCacheOff() : before_(flash_reg::kAcr.read()) { flash_reg::kAcr.write(before_ & ~flash_reg::kDataCache); }
  ~DataCacheOff() {
    flash_reg::kAcr.set(flash_reg::kDataCacheReset);
    flash_reg::kAcr.clear(flash_reg::kDataCacheReset);
    flash_reg::kAcr.set(before_ & flash_reg::kDataCache);
  }
  DataCacheOff(const DataCacheOff&) = delete;
  DataCacheOff& operator=(const DataCacheOff&) = delete;

 private:
  std::uint32_t before_;
};

bool in_flash(std::uint32_t address) {
  return address >= flash_map::kBase && address < flash_map::kEnd;
}

// A chip that has two banks may be set to one; its pages then have 4 KB and other numbers, so an erase would also
// delete a neighbour.
bool pages_as_mapped() {
  return (flash_reg::kOptr.read() & flash_reg::kDualBank) == flash_reg::kDualBank;
}

// RM0440 §3.4.2 has the procedure. The chip uses the new bytes after its next power-up.
bool write_option(Register option, std::uint32_t value) {
  wait_ready();
  const DataCacheOff data_cache_off;
  const Unlocked unlocked;
  flash_reg::kOptKeyr.write(flash_reg::kOptionKey1);
  flash_reg::kOptKeyr.write(flash_reg::kOptionKey2);
  flash_reg::kSr.write(flash_reg::kErrors | flash_reg::kEndOfOperation);
  option.write(value);
  flash_reg::kCr.write(flash_reg::kOptionStart);
  wait_through_erase();
  return end_operation();
}

}  // namespace

void do_while_erasing(const BusyWork* work) {
  busy_work = work;
}

bool erase_flash_page(std::uint32_t address) {
  if (!in_flash(address) || address % flash_map::kPageBytes != 0 || !pages_as_mapped()) return false;
  const bool second = address >= flash_map::kBank2;
  const std::uint32_t page = (address - (second ? flash_map::kBank2 : flash_map::kBase)) / flash_map::kPageBytes;
  wait_ready();
  const DataCacheOff data_cache_off;
  const Unlocked unlocked;
  flash_reg::kSr.write(flash_reg::kErrors | flash_reg::kEndOfOperation);
  const std::uint32_t command =
      flash_reg::kPageErase | page << flash_reg::kPageShift | (second ? flash_reg::kBank2 : 0U);
  flash_reg::kCr.write(command);
  flash_reg::kCr.write(command | flash_reg::kStart);
  wait_through_erase();
  return end_operation();
}

bool write_flash_options(std::uint32_t options) {
  return write_option(flash_reg::kOptr, options);
}

bool write_flash_protection(std::uint32_t pages) {
  return write_option(flash_reg::kWrp1Ar, pages);
}

bool program_flash_unit(std::uint32_t address, std::uint32_t low, std::uint32_t high) {
  if (!in_flash(address) || address % flash_map::kUnitBytes != 0) return false;
  wait_ready();
  const DataCacheOff data_cache_off;
  const Unlocked unlocked;
  flash_reg::kSr.write(flash_reg::kErrors | flash_reg::kEndOfOperation);
  flash_reg::kCr.write(flash_reg::kProgram);
  {
    const InterruptLock lock;  // No other write may come between the two halves of a unit.
    Register(address).write(low);
    Register(address + 4).write(high);
  }
  return end_operation();
}

}  // namespace triskin::board

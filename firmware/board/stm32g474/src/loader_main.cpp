// SPDX-License-Identifier: Apache-2.0
// Starts the newest application that has proved itself or still may; takes a new one over CAN, and as a DFU device over
// USB when the application asked for that or there is none.
#include <algorithm>
#include <optional>

#include "can.hpp"
#include "flash_area.hpp"
#include "triskin/board/board.hpp"
#include "triskin/board/flash_map.hpp"
#include "triskin/board/registers/system.hpp"
#include "triskin/boot/dfu_device.hpp"
#include "triskin/boot/loader.hpp"
#include "usb.hpp"

namespace triskin::board {
namespace {

constexpr std::uint64_t kLook_us = 10'000;

[[noreturn]] void start(int slot) {
  const std::uint32_t vectors = flash_map::kSlots[slot];
  const auto* table = reinterpret_cast<const std::uint32_t*>(vectors);
  asm volatile("cpsid i" ::: "memory");
  core_reg::kVtor.write(vectors);
  asm volatile("msr msp, %0\n bx %1" ::"r"(table[0]), "r"(table[1]));
  __builtin_unreachable();
}

void start_newest() {
  const int slot = application_slots.choose();
  if (slot < 0) return;
  if (!application_slots.inspect(slot).confirmed && !application_slots.note_start(slot)) return;
  start_watchdog();  // a new application that hangs comes back here
  core_reg::reset_peripherals();
  start(slot);
}

// Back to the application; without one the loader begins anew, and so does a host that has not given up.
[[noreturn]] void leave_dfu() {
  usb.close();
  start_newest();
  core_reg::reset();
}

// Interrupts stay off between the decision and WFI, which wakes all the same.
void sleep_until(std::uint64_t at_us) {
  asm volatile("cpsid i" ::: "memory");
  if (!can.frame_waits() && !usb.work_waits()) {
    wake_at(std::min(at_us, microseconds() + kLook_us));
    asm volatile("dsb\n wfi" ::: "memory");
  }
  asm volatile("cpsie i\n isb" ::: "memory");
}

}  // namespace
}  // namespace triskin::board

int main() {
  using namespace triskin::board;
  start_clocks();
  start_microseconds();
  can.open(CanFilters::kLoader);
  triskin::boot::Loader loader(application_slots, can, unique_id());
  static std::optional<triskin::boot::DfuDevice> dfu;
  bool dfu_wanted = take_dfu_request();
  const std::uint64_t window_end = microseconds() + triskin::wire::loader::kWindow_us;
  for (;;) {
    while (const auto frame = can.receive()) {
      if (loader.handle(*frame, microseconds())) start_newest();
    }
    if (dfu_wanted && !dfu) {
      dfu.emplace(application_slots, unique_id());
      dfu->tick(microseconds());
      usb.open(*dfu, false);
    }
    usb.serve();
    std::uint64_t end = std::max(window_end, loader.stays_until_us());
    if (dfu) {
      dfu->tick(microseconds());
      end = std::max(end, dfu->next_event_us());
      if (dfu->wants_to_reconnect() && usb.idle()) leave_dfu();
    } else if (microseconds() >= end) {
      start_newest();
      dfu_wanted = true;  // there is none
    }
    feed_watchdog();
    sleep_until(end);
  }
}

// SPDX-License-Identifier: Apache-2.0
// Starts the newest application that is confirmed or may still be tried. Receives a new one over CAN, and as a DFU
// device over USB when the application asked for that or there is none.
#include <algorithm>
#include <optional>

#include "can.hpp"
#include "flash_area.hpp"
#include "light.hpp"
#include "triskin/board/board.hpp"
#include "triskin/board/board_config.hpp"
#include "triskin/board/flash_map.hpp"
#include "triskin/board/registers/system.hpp"
#include "triskin/board/survivor.hpp"
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
  // What was fetched ahead from one bank must not meet the jump into the other: errata ES0548 2.2.10, of a sister chip.
  // The application switches it on again.
  flash_reg::kAcr.clear(flash_reg::kPrefetch);
  core_reg::kVtor.write(vectors);
  asm volatile("msr msp, %0\n bx %1" ::"r"(table[0]), "r"(table[1]));
  __builtin_unreachable();
}

// Returns the image to start, or −1. After too many crashes the other image is used, and after as many crashes of
// that one the loader waits for a host, or for the next power-up.
int slot_to_start() {
  const int slot = application_slots.choose();
  const std::uint32_t crashes = survivor().crashes_in_row;
  if (slot < 0 || crashes < kMaxCrashesInRow) return slot;
  const bool other = application_slots.inspect(1 - slot).valid;
  return other && crashes < 2 * kMaxCrashesInRow ? 1 - slot : -1;
}

void start_image() {
  const int slot = slot_to_start();
  if (slot < 0) return;
  if (!application_slots.inspect(slot).confirmed) (void)application_slots.note_start(slot);
  feed_watchdog();  // A new application that hangs is reset into the loader by the watchdog.
  note_application_starts();
  core_reg::reset_peripherals();
  start(slot);
}

// Starts because a host asks for it; the host may have brought an image that does not crash.
void start_on_request() {
  survivor().crashes_in_row = 0;
  start_image();
}

// Returns to the application. Without one the loader restarts, and a host that has not given up can start again.
[[noreturn]] void leave_dfu(bool committed) {
  usb.close();
  if (committed) survivor().crashes_in_row = 0;
  start_image();
  core_reg::reset();
}

// Interrupts stay disabled between the decision and WFI, which wakes anyway.
void sleep_until(std::uint64_t at_us) {
  asm volatile("cpsid i" ::: "memory");
  if (!can.frame_waits() && !(config::kUsb && usb.work_waits())) {
    wake_at(std::min(at_us, microseconds() + kLook_us));
    asm volatile("dsb\n wfi" ::: "memory");
  }
  asm volatile("cpsie i\n isb" ::: "memory");
}

}  // namespace
}  // namespace triskin::board

namespace triskin::board {
namespace {

// The loader is in this state until an application starts.
class Waiting {
 public:
  Waiting() : loader_(application_slots, can, unique_id()), window_end_us_(microseconds() + wire::loader::kWindow_us) {}

  [[noreturn]] void run(bool dfu_wanted) {
    if (dfu_wanted) open_dfu(true);
    for (;;) {
      while (const auto frame = can.receive()) {
        if (loader_.handle(*frame, microseconds())) start_on_request();
      }
      if constexpr (config::kUsb) usb.serve();
      can.step(microseconds());
      const std::uint64_t end_us = std::max(window_end_us_, loader_.stays_until_us());
      if (dfu_)
        serve_dfu(end_us);
      else if (microseconds() >= end_us)
        start_or_wait();
      if (dfu_ || waits_) show(Light::kLoader, microseconds());
      feed_watchdog();
      sleep_until(dfu_ ? std::max(end_us, dfu_->next_event_us()) : end_us);
    }
  }

 private:
  // A board without USB waits on CAN and checks again later.
  void open_dfu(bool leaves) {
    if constexpr (!config::kUsb) {
      constexpr std::uint64_t kLookAgain_us = 15'000'000;
      waits_ = true;
      window_end_us_ = microseconds() + kLookAgain_us;
      return;
    }
    dfu_.emplace(application_slots, unique_id(), leaves);
    dfu_->tick(microseconds());
    usb.open(*dfu_, false);
  }
  void start_or_wait() {
    start_image();
    open_dfu(false);  // No application may start, so it waits without limit.
  }
  void serve_dfu(std::uint64_t can_until_us) {
    dfu_->tick(microseconds());
    const bool host_on_can = microseconds() < can_until_us;
    if (dfu_->wants_to_reconnect() && usb.idle() && !host_on_can) leave_dfu(dfu_->committed());
  }

  boot::Loader loader_;
  std::optional<boot::DfuDevice> dfu_;
  std::uint64_t window_end_us_;
  bool waits_ = false;
};

}  // namespace
}  // namespace triskin::board

int main() {
  using namespace triskin::board;
  open_survivor();
  start_watchdog();
  start_clocks();
  start_microseconds();
  open_light();
  const bool wanted = take_dfu_request();
  const bool pressed = take_double_reset();
  can.open(CanFilters::kLoader);
  static Waiting waiting;
  waiting.run(wanted || pressed);
}

// SPDX-License-Identifier: Apache-2.0
// Records what stopped the controller where the next start finds it.
#include "crash.hpp"

#include <array>
#include <utility>

#include "triskin/board/board.hpp"
#include "triskin/board/budget.hpp"
#include "triskin/board/flash_map.hpp"
#include "triskin/board/registers/system.hpp"
#include "triskin/board/survivor.hpp"
#include "triskin/layout/image_label.hpp"

extern "C" {
extern std::uint32_t triskin_survivor[];
extern std::uint32_t triskin_stack_bottom, triskin_stack_top, triskin_code_start, triskin_code_end, triskin_image_end;
void note_fault(const std::uint32_t* frame);
}

namespace triskin::board {
namespace {

constexpr std::uint32_t kMagic = 0x53555256, kMark = 0x6D61726B;
// The words are the first one of a label and the one with the version (layout/image_label.hpp).
constexpr std::uint32_t kLabelMark = ByteReader(layout::kLabelMagic).le32();
constexpr std::size_t kLabelVersionWord = 4;
// The positions in an exception frame (ARMv7-M, B1.5.6) are in words.
constexpr std::size_t kFrameLr = 5, kFramePc = 6, kFrameWords = 8;

std::uint32_t address_of(const void* p) {
  return static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(p));
}

// An odd word that points into the code of this image is usually a return address.
bool is_return_address(std::uint32_t word) {
  const bool in_flash = word >= image_origin() && word < address_of(&triskin_image_end);
  const bool in_ram = word >= address_of(&triskin_code_start) && word < address_of(&triskin_code_end);
  return (word & 1) != 0 && (in_flash || in_ram);
}

// When the stack has left its memory, nothing was pushed; the deepest return address that is still there names the
// function.
std::uint32_t deepest_return_address() {
  for (const std::uint32_t* p = &triskin_stack_bottom; p < &triskin_stack_top; ++p) {
    if (is_return_address(*p)) return *p;
  }
  return 0;
}

bool in_stack(const std::uint32_t* frame) {
  return frame >= &triskin_stack_bottom && frame + kFrameWords <= &triskin_stack_top;
}

void note_place(wire::Crash& crash, const std::uint32_t* frame) {
  crash.sp = address_of(frame);
  if (!in_stack(frame)) {
    crash.lr = deepest_return_address();
    return;
  }
  crash.pc = frame[kFramePc];
  crash.lr = frame[kFrameLr];
}

// The loader has no label, so its version is unknown.
std::uint32_t image_version() {
  const auto* words = reinterpret_cast<const std::uint32_t*>(image_origin() + layout::kLabelOffset);
  return words[0] == kLabelMark ? words[kLabelVersionWord] : 0;
}

[[noreturn]] void finish(wire::Crash& crash, wire::CrashCause cause) {
  Survivor& s = survivor();
  crash.cause = cause;
  crash.while_erasing = flash_reg::kSr.any(flash_reg::kBusy);
  crash.uptime_ms = s.uptime_ms;
  crash.firmware_version = image_version();
  crash.origin = image_origin();
  crash.number = ++s.crashes;
  s.crash = crash;
  core_reg::reset();
}

wire::Crash begin() {
  wire::Crash crash;
  crash.exception = static_cast<std::uint16_t>(core_reg::kIcsr.read() & core_reg::kActiveMask);
  return crash;
}

std::uint32_t fault_address(std::uint32_t status) {
  if ((status & core_reg::kBfarValid) != 0) return core_reg::kBfar.read();
  return (status & core_reg::kMmfarValid) != 0 ? core_reg::kMmfar.read() : 0;
}

// A watchdog reset with interrupts disabled has left no record.
void note_bite(Survivor& s) {
  wire::Crash crash;
  crash.cause = wire::CrashCause::kWatchdog;
  crash.uptime_ms = s.uptime_ms;
  crash.number = ++s.crashes;
  s.crash = crash;
}

}  // namespace

Survivor& survivor() {
  return *reinterpret_cast<Survivor*>(triskin_survivor);
}

void fail(wire::CrashCause cause) {
  wire::Crash crash = begin();
  crash.lr = address_of(__builtin_return_address(0));
  finish(crash, cause);
}

void note_hang(const std::uint32_t* frame) {
  wire::Crash crash = begin();
  crash.exception = 0;  // The exception would be that of the timer.
  note_place(crash, frame);
  finish(crash, wire::CrashCause::kWatchdog);
}

void open_survivor() {
  Survivor& s = survivor();
  const std::uint32_t flags = rcc_reg::kCsr.read();
  rcc_reg::kCsr.set(rcc_reg::kRemoveResetFlags);
  constexpr std::uint32_t kCauses = rcc_reg::kOptionReset | rcc_reg::kPinReset | rcc_reg::kPowerReset |
                                    rcc_reg::kSoftwareReset | rcc_reg::kWatchdogReset;
  if ((flags & kCauses) == 0 && s.magic == kMagic) return;  // No reset has happened since the last call.
  if (s.magic != kMagic || (flags & rcc_reg::kPowerReset) != 0) s = Survivor{};
  s.magic = kMagic;
  s.reset_flags = flags;
  const bool was_running = std::exchange(s.running, 0U) == kMark;
  if ((flags & rcc_reg::kWatchdogReset) != 0) note_bite(s);
  const bool crashed = s.crashes != s.crashes_seen;
  s.crashes_seen = s.crashes;
  if (crashed && was_running) ++s.crashes_in_row;
}

void note_application_starts() {
  survivor().running = kMark;
}

void request_dfu() {
  survivor().running = 0;
  survivor().dfu_request = kMark;
}

bool take_dfu_request() {
  return std::exchange(survivor().dfu_request, 0U) == kMark;
}

bool take_double_reset() {
  constexpr std::uint32_t kOthers =
      rcc_reg::kPowerReset | rcc_reg::kSoftwareReset | rcc_reg::kWatchdogReset | rcc_reg::kOptionReset;
  Survivor& s = survivor();
  const bool pin = (s.reset_flags & rcc_reg::kPinReset) != 0 && (s.reset_flags & kOthers) == 0;
  const bool second = std::exchange(s.reset_pressed, pin ? kMark : 0U) == kMark;
  if (pin && second) s.reset_pressed = 0;
  return pin && second;
}

void end_double_reset() {
  survivor().reset_pressed = 0;
}

}  // namespace triskin::board

void note_fault(const std::uint32_t* frame) {
  using namespace triskin::board;
  triskin::wire::Crash crash = begin();
  crash.exception = 0;  // The exception would be that of the fault.
  crash.fault_status = core_reg::kCfsr.read();
  crash.hard_fault_status = core_reg::kHfsr.read();
  crash.address = fault_address(crash.fault_status);
  const bool overflow = (crash.fault_status & core_reg::kStackingFailed) != 0 || !in_stack(frame);
  note_place(crash, overflow ? nullptr : frame);
  if (overflow) crash.sp = address_of(frame);
  finish(crash, overflow ? triskin::wire::CrashCause::kStackOverflow : triskin::wire::CrashCause::kFault);
}
